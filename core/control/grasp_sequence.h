#pragma once

/// `grasp`: closes the fingers from the generic preshape until they touch, whatever the object's
/// size and shape, then grips and has the stand-in let go.

#include <array>

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
    kFailed,  ///< fewer than three fingers touched
  };

  explicit GraspSequence(const HandModel& hand, double dt) : hand_(&hand), dt_(dt) {}
  void Start(const Estimate& estimate);
  /// One tick: writes one task per finger. Starts the holding controller when it grips.
  void Update(const Estimate& estimate, const JointVector& q_closed, const Vector3d& gravity_W,
              const ControlParameters& parameters, HybridController* controller,
              FingerTasks* tasks);

  Phase phase() const { return phase_; }
  /// The stand-in shall hold the object.
  bool needs_stand_in() const { return phase_ < Phase::kAlone || phase_ == Phase::kFailed; }
  /// 0 .. 1.
  double progress() const { return progress_; }
  void AddTo(StateHasher* hasher) const;

 private:
  const HandModel* hand_;
  double dt_;
  Phase phase_ = Phase::kIdle;
  int ticks_ = 0;  // in this phase
  double progress_ = 0;
  JointVector q_start_;
  std::array<bool, kMaxFingers> touched_{};
};

}  // namespace regrasp
