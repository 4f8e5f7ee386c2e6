#pragma once

/// One local manipulation on its own: all fingers hold, and the object moves a little along and
/// about any axis without a regrasp, as far as the fingers reach. A finger that a joint limit has
/// held up yields, while the grasp without it has load margin enough (gait.margin_min): it slides
/// back over the surface, against the motion, until its joints have room for the rest of the way.
/// One that has found no room in gait.slide_limit_s presses lightly, so that it rolls and slips.
/// One finger at a time: the margin counts on the others.

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
    v("yielding", yielding_, v.Finger());
    v("yield_ticks", yield_ticks_);
    v("rest_ticks", rest_ticks_);
  }

 private:
  /// The finger that yields until it has room, else of those at a limit the one that the grasp can
  /// best do without, or -1.
  int YieldingFinger(const ControlTick& tick) const;
  /// The task of the finger that yields.
  void Yield(const ControlTick& tick, FingerTask* task);
  bool slides(const ControlTick& tick) const {
    return yield_ticks_ * tick.dt < tick.gait.slide_limit_s;
  }

  bool active_ = false;
  bool stop_ = false;
  LocalManipulation manipulation_;
  Home home_;
  int yielding_ = -1;    // finger
  int yield_ticks_ = 0;  // since it began to yield
  int rest_ticks_ = 0;   // since the end of the motion
};

}  // namespace regrasp
