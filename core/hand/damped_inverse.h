#pragma once

/// The damped inverse of a finger's Jacobian: near a singular posture it stays bounded.

#include <Eigen/LU>

#include "core/common/frames.h"
#include "core/common/limits.h"

namespace regrasp {

/// (J Jᵀ + d I)⁻¹ [1/m²], d = `damping` [m²] > 0, (1 mm)² where nothing else is wanted. Times J:
/// columns d q_k / d v, the joint rates per velocity of the point.
inline Matrix3d DampedInverse(const FingerJacobian& J, double damping = 1e-6) {
  const Matrix3d JJt = J * J.transpose() + damping * Matrix3d::Identity();
  return JJt.inverse();
}

}  // namespace regrasp
