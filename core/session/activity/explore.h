#pragma once

#include "core/exploration/finger_exploration.h"
#include "core/gait/finger_gait.h"
#include "core/session/activity/activity.h"
#include "core/session/gait_report.h"

namespace regrasp {

/// `explore`: Algorithm 1 with one finger. Before it, where the load margin without the finger is
/// too small, the other fingers shift until it may leave.
class ExploreActivity : public Activity {
 public:
  Verdict MayStart(const Command& command, const ActivityContext& context) override;
  void Start(const Command& command, const ActivityContext& context) override;
  ActivityStep Update(const ActivityContext& context) override;
  ActivityStep Stop(const ActivityContext& context) override;
  void Dropped(const ActivityContext& context) override;
  void Record(const ActivityContext& context, Frame* frame) const override;
  template <typename V>
  void Fields(V& v) {
    v("request", request_);
    v("room", room_);
    v("report", report_);
    v("exploration", exploration_);
    v("p_path", p_path_);
  }

 private:
  ActivityStep MakeRoom(const ActivityContext& context);
  /// The job's record: while the finger slides, and when it has.
  void Assess(const ActivityContext& context);
  void AssessEnd(const ActivityContext& context);
  double TruePhi(const ActivityContext& context) const;

  FingerExploration::Request request_;
  FingerGait room_;  // active: the others shift
  GaitReport report_;
  FingerExploration exploration_;
  Vector3d p_path_ = Vector3d::Zero();  // true contact up to which the path is measured [m]
  char refusal_[kReasonRoom] = {};
};

/// What a frame tells of Algorithm 1. `epsilon`: exploration.epsilon.
ExplorationFrame FrameOf(const GuidedSlide& slide, double epsilon);

}  // namespace regrasp
