#pragma once

/// What exploration maximises: manipulability of the exploring finger, stability of the grasp, a
/// switch between them (Sec. II), or their linear sum (the dotted line of Fig. 2).

#include "core/control/estimate.h"
#include "core/exploration/criterion.h"

namespace regrasp {

struct ObjectiveValue {
  double phi = 0;             ///< of order 1
  bool on_stability = false;  ///< kSwitched: stability is what counts at present
};

/// Stability of the grasp by `fingers`: the measure selected by
/// `parameters.stability_measure` from sensed contacts, torques divided by the estimated object
/// scale. The measure must be fit for a tick (see MayMaximise).
double GraspStability(const Estimate& estimate, FingerSet fingers,
                      const ControlParameters& parameters);

/// Whether exploration by `criterion` can maximise what `parameters` say that stability is: a
/// measure that is too slow for a tick it cannot.
inline bool MayMaximise(Criterion criterion, const ControlParameters& parameters) {
  return !InfoOf(criterion).takes_stability ||
         InfoOf(parameters.stability_measure).cost == MeasureCost::kTick;
}

/// phi of `finger`, in the grasp by `fingers` (which includes it). `was_on_stability`: result of
/// the previous call; kSwitched returns to manipulability only 5 % above the threshold.
ObjectiveValue Objective(Criterion criterion, int finger, FingerSet fingers,
                         const Estimate& estimate, const ControlParameters& parameters,
                         double stability_weight, bool was_on_stability);

}  // namespace regrasp
