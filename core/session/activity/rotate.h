#pragma once

#include "core/session/activity/activity.h"
#include "core/session/gait_report.h"

namespace regrasp {

/// `rotate`: the finger gait.
class RotateActivity : public Activity {
 public:
  void Start(const Command& command, const ActivityContext& context) override;
  ActivityStep Update(const ActivityContext& context) override;
  ActivityStep Stop(const ActivityContext& context) override;
  void Dropped(const ActivityContext& context) override;
  bool Dares(const GaitParameters& parameters) const override { return gait_.dares(parameters); }
  void Record(const ActivityContext& context, Frame* frame) const override;
  template <typename V>
  void Fields(V& v) {
    v("gait", gait_);
    v("report", report_);
    v("q_WO_start", q_WO_start_);
    v("p_WO_start", p_WO_start_);
  }

 private:
  /// The truth about the rotation so far, every tick so that no turn is missed.
  void Assess(const ActivityContext& context) const;
  /// The gait has ended by itself: failed where the object, judged, is not where it was to be.
  ActivityStep Done(const ActivityContext& context) const;

  FingerGait gait_;
  GaitReport report_;
  // True, when the rotation began.
  Quaterniond q_WO_start_ = Quaterniond::Identity();
  Vector3d p_WO_start_ = Vector3d::Zero();
};

}  // namespace regrasp
