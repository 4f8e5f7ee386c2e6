#include "core/gait/explorations.h"

#include <algorithm>

namespace regrasp {

bool Explorations::Explores(const GaitParameters& parameters, int finger, bool unknown) const {
  if (parameters.mode != GaitMode::kExploring || parameters.explore == GaitExplore::kNever)
    return false;
  return parameters.explore == GaitExplore::kAlways ||
         gain_[finger].at_least(parameters.explore_gain) || unknown;
}

double Explorations::DiscShare(const ControlTick& tick, int opposing) {
  if (opposing < 0) return 1;
  const GaitParameters& parameters = tick.gait;
  const double margin = tick.margins.without[opposing] - parameters.margin_min;
  const double wanted = parameters.disc_full * parameters.margin_wanted - parameters.margin_min;
  return wanted > 0 ? std::clamp(margin / wanted, 0.0, 1.0) : 1.0;
}

void Explorations::Add(const GaitParameters& parameters, const GuidedSlide& slide,
                       const Vector3d& shift_W) {
  const int finger = slide.request().finger;
  Vector3d& found = found_[finger];
  found += parameters.found_share * (shift_W - found);
  found = LimitNorm(found, parameters.disc_inside * parameters.disc_radius);
  gradient_[finger] = slide.algorithm().gradient_W();
  gain_[finger].Add(RelativeGain(slide.phi_final(), slide.phi_initial()), parameters.found_share);
}

}  // namespace regrasp
