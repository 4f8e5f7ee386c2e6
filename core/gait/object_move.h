#pragma once

/// One local manipulation on its own: all fingers hold, and the object moves a little along and
/// about any axis without a regrasp, as far as the fingers reach. A finger that a joint limit
/// has held up presses lightly from then on, so that it rolls and slips, while the grasp without it
/// has load margin enough (gait.margin_min). One finger at a time: the margin counts on the others.

#include "core/gait/local_manipulation.h"

namespace regrasp {

class ObjectMove {
 public:
  struct Request {
    Vector3d offset_W = Vector3d::Zero();    ///< of the object's centre [m]
    Vector3d rotation_W = Vector3d::Zero();  ///< rotation vector, norm at most pi [rad]
  };

  /// Offset and rotation are not both zero; both go
  /// along their whole way at the same time, at the speed of the slower one.
  void Start(const Request& request, const ControlTick& tick, const ObjectWrench& wrench);
  /// Slows down, then comes to rest.
  void Stop() {
    stop_ = true;
    manipulation_.Stop();
  }
  /// One tick: sets the task of every finger of the grasp, returns the object's motion. Where the
  /// motion ends early the object's reference becomes where it is.
  ObjectMotion Update(const ControlTick& tick, HybridController* controller, FingerTasks* tasks);

  /// Moves, or comes to rest after its end.
  bool active() const { return active_; }
  bool stopped() const { return stop_; }  ///< Stop() was called
  double progress() const { return manipulation_.travelled() / manipulation_.length(); }  ///< 0..1
  const LocalManipulation& manipulation() const { return manipulation_; }
  template <typename V>
  void Fields(V& v) {
    v("active", active_);
    v("stop", stop_);
    v("manipulation", manipulation_);
    v("home", home_);
    v("rest_ticks", rest_ticks_);
  }

 private:
  /// Of the fingers at a limit the one that the grasp can best do without, or -1.
  int YieldingFinger(const ControlTick& tick) const;

  bool active_ = false;
  bool stop_ = false;
  LocalManipulation manipulation_;
  Home home_;
  int rest_ticks_ = 0;  // since the end of the motion
};

}  // namespace regrasp
