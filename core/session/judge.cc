#include "core/session/judge.h"

namespace regrasp {
namespace {

/// Filters off: turns noise-free readings into the truth in the controller's own terms.
ControlParameters Unfiltered(ControlParameters parameters) {
  parameters.joint_filter_s = parameters.force_filter_s = 0;
  parameters.contact_filter_s = parameters.pose_filter_s = 0;
  parameters.contact_from_normal = false;
  return parameters;
}

}  // namespace

void Judge::Look(std::int64_t tick, const WorldState& truth, const ControlParameters& parameters) {
  estimator_.Update(sensors_.Read(tick, truth), Unfiltered(parameters));
}

double Judge::Phi(Criterion criterion, int finger, FingerSet fingers, const Parameters& parameters,
                  bool on_stability) const {
  return Objective(criterion, finger, fingers, estimate(), parameters.control,
                   parameters.exploration.stability_weight, on_stability)
      .phi;
}

}  // namespace regrasp
