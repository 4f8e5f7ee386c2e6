#pragma once

/// What exploration maximises: manipulability of the exploring finger, stability of the grasp, a
/// switch between them (Sec. II), or their linear sum (the dotted line of Fig. 2).

#include <cstdint>
#include <string_view>

#include "core/control/estimate.h"

namespace regrasp {

enum class Criterion : std::uint8_t { kManipulability, kStability, kSwitched, kCombined };
std::string_view Name(
    Criterion criterion);  ///< "manipulability", "stability", "switched", "combined"

struct ObjectiveValue {
  double phi = 0;             ///< of order 1
  bool on_stability = false;  ///< kSwitched: stability is what counts at present
};

/// Stability of the grasp by `fingers`: the measure selected by
/// `parameters.stability_measure` from sensed contacts, torques divided by the estimated object
/// scale. (kEpsilon is too slow for every tick: it falls back to the smallest singular value here.)
double GraspStability(const Estimate& estimate, FingerSet fingers,
                      const ControlParameters& parameters);

/// phi of `finger`, in the grasp by `fingers` (which includes it). `was_on_stability`: result of
/// the previous call; kSwitched returns to manipulability only 5 % above the threshold.
ObjectiveValue Objective(Criterion criterion, int finger, FingerSet fingers,
                         const Estimate& estimate, const ControlParameters& parameters,
                         double stability_weight, bool was_on_stability);

}  // namespace regrasp
