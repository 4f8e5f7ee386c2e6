#pragma once

/// What every controller of one tick sees: the hand, the sensed state and the constants. One
/// struct, made once a tick, so that the layers of the controller (grasp, exploration, gait) take
/// the same few arguments.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/common/finger_set.h"
#include "core/control/control_parameters.h"
#include "core/control/estimate.h"
#include "core/hand/hand_model.h"

namespace regrasp {

struct ExplorationParameters;
struct GaitParameters;
class FeltSurface;

/// Load margins rho of the present grasp from sensed contacts, low-passed with
/// control.margin_filter_s [N]. One of them is computed every QualityMonitor::kMarginInterval, in
/// turn: of n fingers each is up to n + 1 of these old, of five 30 ms, before the low pass.
struct LoadMargins {
  double all = 0;                             ///< with all fingers of the grasp
  std::array<double, kMaxFingers> without{};  ///< without one finger, by finger
  template <typename V>
  void Fields(V& v) {
    v("all", all, kUnbounded);
    v("without", without, kUnbounded);
  }
};

/// A time as a number of ticks of `dt` [s]: the nearest, at least one.
inline int Ticks(double seconds, double dt) {
  return std::max(1, static_cast<int>(std::lround(seconds / dt)));
}

/// References to what one tick works on; valid during that tick only.
struct ControlTick {
  const HandModel& hand;
  const Estimate& estimate;
  FingerSet grasp;  ///< the fingers that form the grasp
  const LoadMargins& margins;
  const FeltSurface& felt;    ///< the object's surface, in O
  const Vector3d& gravity_W;  ///< [m/s²]
  const ControlParameters& control;
  const ExplorationParameters& exploration;
  const GaitParameters& gait;
  double dt;  ///< [s]

  const FingerEstimate& finger(int i) const { return estimate.fingers[i]; }
};

}  // namespace regrasp
