#pragma once

#include "core/control/estimate.h"
#include "core/exploration/surface_exploration.h"

namespace regrasp {

/// What a finger that touches with the side of its last link is to do.
enum class OnSide : std::uint8_t {
  kLeave,  ///< slide onto its round tip: the wall there is blind
  kStay,   ///< explore there
};

/// What a sliding finger must not run into: its joint limits, from `limit_margin` on, the other
/// fingers, from `clearance` on (of the last two links of each the first capsule: boxes and further
/// capsules are not seen), the object, which the rest of its last
/// link keeps `clearance` from, and the end of its own round tip. A wall's direction is the contact
/// motion that changes its quantity most: for a joint its row of J⁺, for two links the gradient of
/// their distance through J⁺.
void FindWalls(const HandModel& hand, const Estimate& estimate, int finger,
               const ExplorationParameters& parameters, OnSide on_side, Walls* walls);

}  // namespace regrasp
