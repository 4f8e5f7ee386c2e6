#include "bench/claims/claims.h"

#include <algorithm>
#include <cmath>

#include "core/hand/scenario.h"

namespace regrasp::claims {

SessionConfig MakeConfig(const Options& o, std::uint64_t seed, const std::string& object) {
  SessionConfig config;
  LoadOptions load;
  load.inertia_from_shape = o.inertia_from_shape;
  config.model = LoadScenario(o.hand, object, ModelSearchPath(), load);
  config.parameters = DefaultParameters(config.model);
  config.noise = NoisePreset(o.noise).value();
  config.seed = seed;
  if (o.exact) config.world.stepper = Stepper::kExact;
  if (o.tilt >= 0) {
    const double t = o.tilt * M_PI / 180;
    config.parameters.gravity_W = 9.81 * Vector3d(0, std::cos(t), std::sin(t));
  }
  Apply(o.set, &config.parameters);
  return config;
}

double Mean(const std::vector<double>& v) {
  double sum = 0;
  for (double x : v) sum += x;
  return v.empty() ? 0 : sum / static_cast<double>(v.size());
}
double Max(const std::vector<double>& v) {
  return v.empty() ? 0 : *std::max_element(v.begin(), v.end());
}

}  // namespace regrasp::claims
