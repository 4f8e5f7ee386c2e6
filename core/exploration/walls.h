#pragma once

#include "core/control/estimate.h"
#include "core/exploration/exploration_parameters.h"

namespace regrasp {

/// Directions in which a sliding finger must not go on, as unit tangents at its contact, in W: those that
/// bring a joint nearer to its limit when it is within `limit_margin`, or its tip link nearer to another
/// finger's when they are within `clearance`. Joint limits use the damped-free row of J⁺: the contact
/// velocity that moves this joint most.
void FindWalls(const HandModel& hand, const Estimate& estimate, int finger,
               const ExplorationParameters& parameters, FixedVector<Vector3d, 8>* walls_W);

}  // namespace regrasp
