#pragma once

/// The local manipulation controller: all fingers hold, and the object moves a little with them. It
/// moves the reference of the object-level force control (core/control) and knows when it has
/// reached its end.

#include <string_view>

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"
#include "core/gait/gait_parameters.h"
#include "core/gait/stance.h"

namespace regrasp {

class LocalManipulation {
 public:
  enum class End : std::uint8_t {
    kNone,            ///< still moving
    kReached,         ///< where it should
    kJointLimit,      ///< a joint has come to its limit and would have to go on
    kStuck,           ///< the object has not followed its reference for some time
    kManipulability,  ///< a finger is near a singular posture
    kExcursion,       ///< a contact is too far from its first place
    kMargin,          ///< the grasp could hardly carry more
    kStopped,
  };

  /// What it means that a joint has come to its limit and would have to go on.
  enum class AtLimit : std::uint8_t {
    kEnds,    ///< the motion ends
    kYields,  ///< its finger shall roll and slip; the motion ends when the object follows no more
  };

  /// A motion of the object along a straight path of length `length` (>= 0). `per_path`: its
  /// velocity per speed along the path. A turn: length in rad, w_W the unit axis through the
  /// object's centre. A shift: length in m, w_W zero, v_W a unit vector. Both at once: length in
  /// rad, w_W the unit axis, v_W in m/rad. `speed`, `acceleration`: along the path, > 0.
  void Start(const ObjectMotion& per_path, double length, double speed, double acceleration,
             AtLimit policy);
  /// Slows down and ends with kStopped.
  void Stop() { stop_ = true; }
  /// One tick, in which all fingers of the grasp hold: the motion of the object reference. `home`:
  /// what the ends are judged against.
  ObjectMotion Update(const ControlTick& tick, const ObjectWrench& wrench, const Home& home);

  End end() const { return end_; }
  int end_finger() const { return end_finger_; }  ///< whose limit it was, or -1
  /// The fingers that have had a joint at a limit against which they would have moved.
  FingerSet at_limit() const { return at_limit_; }
  /// Whether the joints of `finger`, at their present rates, stay off their limits to the end of
  /// the path.
  bool HasRoom(const ControlTick& tick, int finger) const;
  /// The finger is off its limit again.
  void Freed(int finger) { at_limit_.remove(finger); }
  /// Velocity of the finger's contact per path, as it goes with the object [m].
  Vector3d ContactRate(const ControlTick& tick, int finger) const;
  double length() const { return length_; }        ///< of the path [rad, or m for a shift]
  double travelled() const { return travelled_; }  ///< by the reference since Start, same unit
  double speed() const { return speed_; }          ///< along the path [1/s]
  template <typename V>
  void Fields(V& v) {
    v("per_path", per_path_);
    v("length", length_);
    v("speed_max", speed_max_);
    v("acceleration", acceleration_);
    v("travelled", travelled_);
    v("speed", speed_);
    v("policy", policy_, AtLimit::kYields);
    v("stop", stop_);
    v("at_limit", at_limit_);
    v("at_limit_at_first", at_limit_at_first_);
    v("limited_finger", limited_finger_, v.Finger());
    v("waited", waited_);
    v("end", end_, End::kStopped);
    v("end_finger", end_finger_, v.Finger());
  }

 private:
  End FindEnd(const ControlTick& tick, const Home& home);
  /// Whether a joint of the finger stands at a limit and would have to go on when its contact moves
  /// with `v_W` per unit of path.
  bool AtJointLimit(const ControlTick& tick, int finger, const Vector3d& v_W) const;
  bool turns() const { return !per_path_.w_W.isZero(0); }

  ObjectMotion per_path_;
  double length_ = 0, speed_max_ = 0, acceleration_ = 0;
  double travelled_ = 0, speed_ = 0;
  AtLimit policy_ = AtLimit::kEnds;
  bool stop_ = false;
  FingerSet at_limit_;
  FingerSet at_limit_at_first_;  // those with a joint at its limit when the motion began
  int limited_finger_ = -1;      // in this tick
  int waited_ = 0;               // ticks
  End end_ = End::kNone;
  int end_finger_ = -1;
};

std::string_view Name(LocalManipulation::End end);  ///< "reached", "joint limit", ...

}  // namespace regrasp
