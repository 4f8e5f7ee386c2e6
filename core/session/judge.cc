#include "core/session/judge.h"

#include "core/quality/load_margin.h"

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

double Judge::Phi(ObjectiveOf of, const Parameters& parameters, bool on_stability) const {
  const ControlParameters& control = parameters.control;
  if (InfoOf(of.criterion).takes_load_margin) {
    const Grasp grasp = GraspOf(estimate(), of.fingers, control.friction_estimate);
    of.margin =
        LoadMargin({grasp.data(), grasp.size()}, control.mass_estimate * parameters.gravity_W,
                   estimate().object_scale, control.max_normal_force);
  }
  return Objective(*hand_, of, estimate(), control, parameters.exploration, on_stability).phi;
}

}  // namespace regrasp
