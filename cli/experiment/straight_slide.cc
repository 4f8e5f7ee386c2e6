#include "cli/experiment/straight_slide.h"

#include <cmath>
#include <numbers>

#include "core/common/random.h"

namespace regrasp::cli {

std::int64_t SeedOfDirection(double angle_rad) {
  constexpr double kClose = std::numbers::pi / 360;
  for (std::int64_t seed = 1;; ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), 0);  // as SurfaceExploration::Start
    const double x = random.Normal(), y = random.Normal();
    const double off = std::remainder(std::atan2(y, x) - angle_rad, 2 * std::numbers::pi);
    if (std::abs(off) < kClose) return seed;
  }
}

}  // namespace regrasp::cli
