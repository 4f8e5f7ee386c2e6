#pragma once

#include <span>

#include "core/quality/grasp.h"

namespace regrasp {

/// Load margin rho [N]: the largest delta for which the contacts, inside their (round) friction cones,
/// balance the weight plus delta * d for all 12 unit wrenches d = +-force along the axes, +-torque about
/// the axes (torques divided by torque_scale). 0 where they cannot hold the weight. Our addition to the
/// paper: it decides whether a finger may leave. No allocation for up to kMaxFingers contacts.
/// weight: the force of gravity on the object [N]; torque_scale: [m]; max_force: cap on each normal force
/// [N], infinity for none.
double LoadMargin(std::span<const GraspContact> contacts, const Vector3d& weight, double torque_scale,
                  double max_force = 1e30);

}  // namespace regrasp
