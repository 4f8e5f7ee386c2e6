#pragma once

/// `grasp`: closes the fingers from the generic preshape until they touch, whatever the object's
/// size and shape, then grips and has the stand-in let go.

#include <array>

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"

namespace regrasp {

class GraspSequence {
 public:
  enum class Phase : std::uint8_t {
    kIdle,
    kClose,  ///< joints move to the closed posture, then tips towards the object; who touches waits
    kGrip,   ///< all hold, caps ramp from waiting force to grip; the stand-in still holds
    kAlone,  ///< the stand-in has let go; settling
    kDone,
    kFailed,  ///< fewer than three fingers touched, of fewer than three not all
  };

  void Start(const Estimate& estimate);
  /// One tick: writes one task per finger. Starts the holding controller when it grips.
  void Update(const ControlTick& tick, const JointVector& q_closed, HybridController* controller,
              FingerTasks* tasks);

  Phase phase() const { return phase_; }
  /// The stand-in shall hold the object.
  bool needs_stand_in() const { return phase_ < Phase::kAlone || phase_ == Phase::kFailed; }
  /// 0 .. 1.
  double progress() const { return progress_; }
  template <typename V>
  void Fields(V& v) {
    v("phase", phase_, Phase::kFailed);
    v("ticks", ticks_);
    v("progress", progress_);
    v("q_start", q_start_);
    v("touched", touched_);
  }

 private:
  Phase phase_ = Phase::kIdle;
  int ticks_ = 0;  // in this phase
  double progress_ = 0;
  JointVector q_start_;
  std::array<bool, kMaxFingers> touched_{};
};

}  // namespace regrasp
