#pragma once

#include "core/control/estimate.h"
#include "core/exploration/surface_exploration.h"

namespace regrasp {

/// What a sliding finger must not run into: its joint limits, from `limit_margin` on, and the other
/// fingers, from `clearance` on (last two links of each), and the end of its own round tip. A
/// joint's wall is the direction of contact motion that moves this joint most, its row of J⁺.
void FindWalls(const HandModel& hand, const Estimate& estimate, int finger,
               const ExplorationParameters& parameters, FixedVector<Wall, 8>* walls);

}  // namespace regrasp
