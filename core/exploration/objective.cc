#include "core/exploration/objective.h"

#include "core/quality/stability.h"

namespace regrasp {
namespace {

constexpr double kHysteresis = 1.05;

}  // namespace

std::string_view Name(Criterion criterion) {
  switch (criterion) {
    case Criterion::kManipulability:
      return "manipulability";
    case Criterion::kStability:
      return "stability";
    case Criterion::kSwitched:
      return "switched";
    case Criterion::kCombined:
      return "combined";
  }
  return "";
}

double GraspStability(const Estimate& estimate, FingerSet fingers,
                      const ControlParameters& parameters) {
  const Grasp grasp = GraspOf(estimate, fingers, parameters.friction_estimate);
  const SingularMeasures m =
      ComputeSingularMeasures({grasp.data(), grasp.size()}, estimate.object_scale);
  switch (parameters.stability_measure) {
    case StabilityMeasure::kSqrtDet:
      return m.sqrt_det;
    case StabilityMeasure::kIsotropy:
      return m.isotropy;
    default:
      return m.min_singular_value;
  }
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
