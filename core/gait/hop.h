#pragma once

/// The way of a finger through the air: off the surface, above it to above its target, down until
/// it touches. Over the felt surface, where that is wanted: then the way keeps above it, and where
/// nothing is found the finger seeks towards the object's centre, and at last goes back to where it
/// left.

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
    kSeek,     ///< nothing there: towards the object's centre
    kGoBack,   ///< nor there: to above where it left, then down again
    kLanded,   ///< touches, or has come too far down to find a surface
    kBlocked,  ///< touches what was in its way
  };
  /// Where it shall land, in W; may move from tick to tick.
  struct Target {
    Vector3d p_WF = Vector3d::Zero();       ///< fingertip centre [m]
    Vector3d normal_W = Vector3d::UnitZ();  ///< outward
    Vector3d p_WO = Vector3d::Zero();  ///< the object's centre, about which the way is an arc [m]
    Vector3d w_W = Vector3d::Zero();   ///< of the object; the way turns with it [rad/s]
  };

  /// From where the finger is.
  void Start(const ControlTick& tick, int finger, bool over_surface);
  /// One tick. `down`: comes down where it is.
  void Update(const ControlTick& tick, const Target& target, bool down, FingerTask* task);

  Phase phase() const { return phase_; }
  bool active() const {
    return phase_ != Phase::kIdle && phase_ != Phase::kLanded && phase_ != Phase::kBlocked;
  }
  template <typename V>
  void Fields(V& v) {
    v("phase", phase_, Phase::kBlocked);
    v("finger", finger_, v.Finger());
    v("over_surface", over_surface_);
    v("went_back", went_back_);
    v("left", left_);
    v("ticks", ticks_);
    v("p_OLeft", p_OLeft_);
    v("normal_OLeft", normal_OLeft_);
    v("late_ticks", late_ticks_);
    v("p_target_W", p_target_W_);
    v("normal_W", normal_W_);
    v("path", path_);
    v("v_carried_W", v_carried_W_);
  }

 private:
  void Enter(Phase phase);
  void Across(const ControlTick& tick, const Target& target, bool down, FingerTask* task);
  void Seek(const ControlTick& tick, FingerTask* task);
  void GoBack(const ControlTick& tick, FingerTask* task);
  /// Raises the target to the height above the felt surface at which a finger crosses it.
  void KeepAbove(const ControlTick& tick);
  /// Moves the target of the fingertip centre on with this velocity against the object [m/s].
  void Reach(const Vector3d& velocity, double dt, FingerTask* task);

  Phase phase_ = Phase::kIdle;
  int finger_ = -1;
  bool over_surface_ = false, went_back_ = false;
  bool left_ = false;  // has been off the surface
  int ticks_ = 0;      // in this phase
  Vector3d p_OLeft_ = Vector3d::Zero(), normal_OLeft_ = Vector3d::UnitZ();  // where it left, in O
  int late_ticks_ = 0;                       // kAcross: since the target arrived above its end
  Vector3d p_target_W_ = Vector3d::Zero();   // of the fingertip centre
  Vector3d normal_W_ = Vector3d::UnitZ();    // up
  double path_ = 0;                          // of the target, in this phase [m]
  Vector3d v_carried_W_ = Vector3d::Zero();  // of the object where the target is [m/s]
};

}  // namespace regrasp
