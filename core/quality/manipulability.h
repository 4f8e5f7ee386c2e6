#pragma once

#include "core/common/limits.h"

namespace regrasp {

/// Manipulability of a finger at its contact point [Yoshikawa 1985]: sqrt(det(J Jᵀ)) with the 3 x n
/// translational Jacobian J of the contact point; unit m³ (joints in rad). 0 when the finger is
/// singular.
double Manipulability(const FingerJacobian& J);

/// Manipulability is of the order of 1e-4 m³ for this class of hand; phi and everything users see
/// is divided by this, so that it is of order 1.
inline constexpr double kManipulabilityUnit = 1e-4;  // m³

}  // namespace regrasp
