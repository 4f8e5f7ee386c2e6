#pragma once

/// A reference that forgives. After a disturbance the object may rest where its reference is not,
/// and the fingers cannot bring it back. Then the reference gives up what lasts of the error, but
/// for a part that keeps the fingers trying; later motions win the rest back, a little each. So an
/// error neither stays for ever nor keeps every later regrasp from beginning.

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"
#include "core/control/object_wrench.h"
#include "core/gait/gait_parameters.h"

namespace regrasp {

class Forgiveness {
 public:
  /// The rotation begins: the reference as it is now is what is won back later.
  void Start(const ObjectWrench& wrench);
  /// One tick of a hold after a disturbance, which has lasted for `held_s` [s].
  void Watch(const ControlTick& tick, double held_s);
  /// The reference follows the object's error, if `gait.forgive` is on, the error is above
  /// gait.recovered of the abort limits and the grasp is sure: its load margin suffices, or the
  /// object has rested (`held`: at the end of a hold). Returns by how much the reference has turned
  /// about the unit vector axis_W [rad].
  double Forgive(const ControlTick& tick, const Vector3d& axis_W, bool held, ObjectWrench* wrench);
  /// What a motion of `step` [rad] about axis_W adds per radian to win back of tilt and place,
  /// `turned` [rad] after the start.
  ObjectMotion WinBack(const GaitParameters& gait, const ObjectWrench& wrench,
                       const Vector3d& axis_W, double turned, double step) const;
  /// Tilt and offset of the reference against where it would be without disturbances [rad, m].
  double tilt_owed(const ObjectWrench& wrench, const Vector3d& axis_W, double turned) const;
  double offset_owed(const ObjectWrench& wrench) const {
    return (p_start_ - wrench.p_ref()).norm();
  }
  /// How often the reference has followed.
  int times() const { return times_; }
  template <typename V>
  void Fields(V& v) {
    v("q_start", q_start_);
    v("p_start", p_start_);
    v("q_still", q_still_);
    v("p_still", p_still_);
    v("times", times_);
  }

 private:
  Vector3d TiltOwed(const ObjectWrench& wrench, const Vector3d& axis_W, double turned) const;

  Quaterniond q_start_ = Quaterniond::Identity();  // of the reference when the rotation began
  Vector3d p_start_ = Vector3d::Zero();
  Quaterniond q_still_ = Quaterniond::Identity();  // sensed, gait.still_s before a hold ends
  Vector3d p_still_ = Vector3d::Zero();
  int times_ = 0;
};

}  // namespace regrasp
