#include "core/exploration/objective.h"

#include <cassert>

#include "core/quality/measures.h"

namespace regrasp {
namespace {

constexpr double kHysteresis = 1.05;

}  // namespace

double GraspStability(const Estimate& estimate, FingerSet fingers,
                      const ControlParameters& parameters) {
  const Grasp grasp = GraspOf(estimate, fingers, parameters.friction_estimate);
  MeasureInput input({grasp.data(), grasp.size()}, estimate.object_scale, kMonitorEdges);
  const MeasureInfo& measure = InfoOf(parameters.stability_measure);
  assert(measure.cost == MeasureCost::kTick);
  return measure.compute(input);
}

ObjectiveValue Objective(Criterion criterion, int finger, FingerSet fingers,
                         const Estimate& estimate, const ControlParameters& parameters,
                         double stability_weight, bool was_on_stability) {
  const double manipulability = estimate.fingers[finger].manipulability;
  if (criterion == Criterion::kManipulability) return {manipulability, false};
  const double stability = GraspStability(estimate, fingers, parameters);
  if (criterion == Criterion::kStability) return {stability, true};
  if (criterion == Criterion::kCombined)
    return {manipulability + stability_weight * stability, false};
  const double threshold = parameters.stability_threshold * (was_on_stability ? kHysteresis : 1.0);
  const bool on_stability = stability < threshold;
  return {on_stability ? stability : manipulability, on_stability};
}

}  // namespace regrasp
