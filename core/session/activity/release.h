#pragma once

#include "core/session/activity/activity.h"

namespace regrasp {

/// `release`: a short pull away from the surface, then the open posture. Takes half a second and is
/// not interrupted.
class ReleaseActivity : public Activity {
 public:
  void Start(const Command&, const ActivityContext&) override {}
  ActivityStep Update(const ActivityContext& context) override;
  ActivityStep Stop(const ActivityContext&) override { return {}; }
  void AddTorque(const ActivityContext& context, JointVector* torque) const override;
  template <typename V>
  void Fields(V&) {}  // its time is the job's
};

}  // namespace regrasp
