#include "core/session/quality_monitor.h"

#include "core/exploration/objective.h"
#include "core/quality/load_margin.h"
#include "core/quality/stability.h"

namespace regrasp {

QualityMonitor::QualityMonitor() = default;

void QualityMonitor::Update(const Estimate& estimate, unsigned fingers, const Vector3d& gravity_W,
                            const ControlParameters& parameters) {
  const Grasp grasp = GraspOf(estimate, fingers, parameters.friction_estimate);
  const std::span<const GraspContact> contacts(grasp.data(), grasp.size());
  const double scale = estimate.object_scale;
  const SingularMeasures m = ComputeSingularMeasures(contacts, scale);
  stability_.min_singular_value = m.min_singular_value;
  stability_.sqrt_det = m.sqrt_det;
  stability_.isotropy = m.isotropy;
  stability_.threshold = parameters.stability_threshold;
  switch (static_cast<StabilityMeasure>(static_cast<int>(parameters.stability_measure))) {
    case StabilityMeasure::kMinSingularValue: stability_.active = m.min_singular_value; break;
    case StabilityMeasure::kEpsilon: stability_.active = stability_.epsilon; break;
    case StabilityMeasure::kSqrtDet: stability_.active = m.sqrt_det; break;
    case StabilityMeasure::kIsotropy: stability_.active = m.isotropy; break;
  }

  const Vector3d weight = parameters.mass_estimate * gravity_W;
  const int num_fingers = static_cast<int>(estimate.fingers.size());
  if (turn_ >= num_fingers) {
    stability_.load_margin = LoadMargin(contacts, weight, scale, parameters.max_normal_force);
    turn_ = 0;
  } else {
    const Grasp rest = GraspOf(estimate, fingers & ~(1u << turn_), parameters.friction_estimate);
    load_margin_without_[turn_] =
        LoadMargin({rest.data(), rest.size()}, weight, scale, parameters.max_normal_force);
    ++turn_;
  }
}

void QualityMonitor::AddTo(StateHasher* hasher) const {
  hasher->Add(turn_);
  hasher->Add(stability_.load_margin);
  for (double rho : load_margin_without_) hasher->Add(rho);
}

}  // namespace regrasp
