#pragma once

/// The way of a finger through the air: off the surface, above it to above its target, down until
/// it touches.

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"
#include "core/gait/gait_parameters.h"

namespace regrasp {

class Hop {
 public:
  enum class Phase : std::uint8_t {
    kIdle,
    kLift,     ///< off the surface
    kAcross,   ///< above the surface, to above the target
    kDown,     ///< until it touches
    kLanded,   ///< touches, or has come too far down to find a surface
    kBlocked,  ///< touches what was in its way
  };
  /// Where it shall land, in W; may move from tick to tick.
  struct Target {
    Vector3d p_WF = Vector3d::Zero();       ///< fingertip centre [m]
    Vector3d normal_W = Vector3d::UnitZ();  ///< outward
    Vector3d p_WO = Vector3d::Zero();       ///< the object's centre, about which the way is an arc
  };

  /// From where the finger is.
  void Start(const FingerEstimate& finger);
  /// One tick. `down`: comes down where it is.
  void Update(const ControlTick& tick, const FingerEstimate& finger, const Target& target,
              bool down, FingerTask* task);

  Phase phase() const { return phase_; }
  bool active() const {
    return phase_ == Phase::kLift || phase_ == Phase::kAcross || phase_ == Phase::kDown;
  }
  template <typename V>
  void Fields(V& v) {
    v("phase", phase_, Phase::kBlocked);
    v("late_ticks", late_ticks_);
    v("p_target_W", p_target_W_);
    v("normal_W", normal_W_);
    v("path", path_);
  }

 private:
  void Enter(Phase phase);
  void Across(const ControlTick& tick, const FingerEstimate& finger, const Target& target,
              bool down, FingerTask* task);
  /// Moves the target of the fingertip centre on with this velocity [m/s].
  void Reach(const Vector3d& velocity, double dt, FingerTask* task);

  Phase phase_ = Phase::kIdle;
  int late_ticks_ = 0;                      // kAcross: since the target arrived above its end
  Vector3d p_target_W_ = Vector3d::Zero();  // of the fingertip centre
  Vector3d normal_W_ = Vector3d::UnitZ();   // up
  double path_ = 0;                         // of the target, in this phase [m]
};

}  // namespace regrasp
