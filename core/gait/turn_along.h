#pragma once

/// The object turns on while one finger regrasps, as fast as those that hold allow:
///
///   w = min(w_max, least motion reserve of the holding fingers / gait.along_ahead_s)
///       * share of their load margin between gait.margin_min and gait.along_margin
///
/// and it waits while the object is behind its reference. So a finger near its limit slows the turn
/// before it stops it, and an object that is only just held rests while a finger is away.

#include "core/control/control_tick.h"
#include "core/control/object_wrench.h"

namespace regrasp {

class TurnAlong {
 public:
  /// The object rests.
  void Stop() { speed_ = 0; }
  double speed() const { return speed_; }  ///< [rad/s]
  /// One tick: the speed of the reference about `axis_W` (unit, sense included), at most `most`
  /// [rad/s]. `holds`: the fingers that hold; `margin`: load margin of the grasp by them [N].
  double Update(const ControlTick& tick, const ObjectWrench& wrench, FingerSet holds, double margin,
                const Vector3d& axis_W, double most);
  template <typename V>
  void Fields(V& v) {
    v("next", next_, FieldRange{0, kMaxFingers});
    v("reserve", reserve_);
    v("speed", speed_);
  }

 private:
  int next_ = 0;                               // whose reserve is looked at next, one a tick
  std::array<double, kMaxFingers> reserve_{};  // as far as it counts [rad]
  double speed_ = 0;
};

}  // namespace regrasp
