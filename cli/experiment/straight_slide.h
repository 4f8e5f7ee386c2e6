#pragma once

/// Algorithm 1 as a straight slide along a ray: how the map of phi is made, through a daemon
/// (phi_map.h) and without one (bench/phi_map.cc).

#include <array>
#include <cstdint>
#include <utility>

namespace regrasp::cli {

/// Parameters of such a slide: the gradient is never updated, the finger moves as fast as is
/// allowed, and from the side of a link along the ray too, where an exploration would leave it
/// first.
inline constexpr std::array<std::pair<const char*, double>, 3> kStraightSlide = {
    std::pair{"exploration.update_cycles", 10000.0}, std::pair{"exploration.eta", 0.01},
    std::pair{"exploration.onto_tip_s", 0.0}};

/// The seed of an exploration whose start gradient (line 2 of Algorithm 1) lies within half a
/// degree of `angle_rad` in the tangent plane, counted from the first tangent axis.
std::int64_t SeedOfDirection(double angle_rad);

}  // namespace regrasp::cli
