#pragma once

/// A grasp as far as it is sure: a contact's normal may be another one, above all near an edge, and
/// a load margin that knows of it means that the object does not roll when a finger leaves.

#include "core/control/estimate.h"
#include "core/shape/felt_surface.h"

namespace regrasp {

/// The friction coefficient that is left of `mu` when the normal may be off by `tilt` [rad]: that
/// of the largest cone inside all the cones about such normals.
double FrictionUnderTilt(double mu, double tilt);

/// GraspOf(), each contact with the friction that is left when its normal is off by `doubt` times
/// the spread of the normals felt about it.
Grasp SureGraspOf(const Estimate& estimate, FingerSet fingers, double mu, const FeltSurface& felt,
                  double doubt);

}  // namespace regrasp
