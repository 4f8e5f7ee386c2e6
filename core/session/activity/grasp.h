#pragma once

#include "core/control/grasp_sequence.h"
#include "core/session/activity/activity.h"

namespace regrasp {

/// `grasp`: closes the hand; the stand-in lets go when the fingers hold.
class GraspActivity : public Activity {
 public:
  Verdict MayStart(const Command& command, const ActivityContext& context) override;
  void Start(const Command& command, const ActivityContext& context) override;
  ActivityStep Update(const ActivityContext& context) override;
  ActivityStep Stop(const ActivityContext& context) override;
  template <typename V>
  void Fields(V& v) {
    v("sequence", sequence_);
  }

 private:
  GraspSequence sequence_;
  ReasonText refusal_{};
};

}  // namespace regrasp
