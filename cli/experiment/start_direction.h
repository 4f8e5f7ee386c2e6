#pragma once

#include <cstdint>

namespace regrasp::cli {

/// The seed of an exploration whose start gradient (line 2 of Algorithm 1) lies within half a
/// degree of `angle_rad` in the tangent plane, counted from the first tangent axis.
std::int64_t SeedOfDirection(double angle_rad);

}  // namespace regrasp::cli
