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
    kFailed,    ///< fewer than three fingers touched, of fewer than three not all
    kRestless,  ///< alone, but the object goes on moving one way
  };

  /// `q_closed` [rad] is made for an object at `p_WO_expected` [m]; see control.follow_object.
  void Start(const ControlTick& tick, const JointVector& q_closed, const Vector3d& p_WO_expected);
  /// One tick: writes one task per finger. Starts the holding controller when it grips.
  void Update(const ControlTick& tick, HybridController* controller, FingerTasks* tasks);

  Phase phase() const { return phase_; }
  /// The stand-in shall hold the object.
  bool needs_stand_in() const { return phase_ < Phase::kAlone || phase_ == Phase::kFailed; }
  /// Of the object, as sensed: between means over 0.35 s, the last two or the first and the last,
  /// whichever is less; 0 until there are two [m/s].
  double drift_speed() const { return drift_.speed; }
  /// 0 .. 1.
  double progress() const { return progress_; }
  template <typename V>
  void Fields(V& v) {
    v("phase", phase_, Phase::kRestless);
    v("ticks", ticks_);
    v("progress", progress_);
    v("q_start", q_start_);
    v("q_closed", q_closed_);
    v("touched", touched_);
    v("drift", drift_);
  }

 private:
  struct Drift {
    Vector3d sum = Vector3d::Zero();    // of p_WO in this window [m]
    int ticks = 0;                      // in this window
    int windows = 0;                    // before it
    Vector3d first = Vector3d::Zero();  // mean of the first window [m]
    Vector3d last = Vector3d::Zero();   // of the one before this [m]
    double path = 0;                    // through the means so far [m]
    double speed = 0;                   // [m/s]
    /// The means go one way; noise goes back and forth.
    bool directed() const { return (last - first).norm() > 0.5 * path; }
    template <typename V>
    void Fields(V& v) {
      v("sum", sum);
      v("ticks", ticks);
      v("windows", windows);
      v("first", first);
      v("last", last);
      v("path", path);
      v("speed", speed);
    }
  };
  void Watch(const ControlTick& tick);

  Phase phase_ = Phase::kIdle;
  int ticks_ = 0;  // in this phase
  double progress_ = 0;
  JointVector q_start_, q_closed_;
  std::array<bool, kMaxFingers> touched_{};
  Drift drift_;
};

}  // namespace regrasp
