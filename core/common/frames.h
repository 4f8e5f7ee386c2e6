#pragma once

/// Frames and notation, defined once.
///
/// Names follow `<quantity>_<measured-in><target>[_<expressed-in>]`, so that adjacent letters
/// cancel: `p_WQ = X_WC * p_CQ`. Quantities: p position [m], R rotation, X rigid transform, v
/// velocity [m/s], w angular velocity [rad/s], f force [N], n unit normal. q alone is joint angles
/// [rad], q with two frames (q_WO) the rotation R as a quaternion.
///
///   W  world; equal to H (the palm never moves: tilting the palm is done by turning gravity)
///   H  hand: fingers point to +z, the palm's normal is -y, the thumb side is +x
///   O  object: origin at its centre of mass
///   L  a link: origin at its joint
///   F  fingertip: the finger's last link, origin at the centre of the tip's rounding sphere
///   C  contact: origin at the contact point, z along the OUTWARD normal of the object
///
/// In some folders only:
///
///   B  a body of the simulator, or a box: origin at its middle, axes along its edges
///   G  a link of the URDF file that is fixed to a link of the model, or a shape of it (core/hand)
///   I  a link's inertia as the file has it: origin at the centre of mass (core/hand)
///   J  a joint: origin on its axis; P  the link before the joint (core/hand, core/world)
///   R  the root of a hand's file (X_HR); in core/gait the place where a finger slides first (p_WR)
///   S  a collision shape; M  the middle of its bounding sphere (core/world)
///   T  the last link of a finger (X_WT); a taxel (p_LT)
///   OLeft  where a finger left the object, in O (core/gait/hop.h)
///   V  the viewer of a picture, where C is the camera (snapshots)
///
/// Forces `f_*` at a contact are forces ON THE OBJECT unless the name says otherwise.
/// SI units and radians inside; suffixes such as _mm and _deg appear only at the edges.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace regrasp {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// An array of zero vectors: Eigen leaves vectors in `{}` unset.
template <std::size_t n>
std::array<Vector3d, n> ZeroVectors() {
  std::array<Vector3d, n> vectors;
  vectors.fill(Vector3d::Zero());
  return vectors;
}

/// A right-handed rotation whose third column is the unit vector `z`. Deterministic; the tangent
/// axes are otherwise arbitrary. Used for R_WC with z = outward object normal.
inline Matrix3d RotationFromZ(const Vector3d& z) {
  const Vector3d helper = std::abs(z.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  Matrix3d R;
  R.col(2) = z;
  R.col(0) = helper.cross(z).normalized();
  R.col(1) = z.cross(R.col(0));
  return R;
}

/// The part of `v` tangent to the surface with unit normal `n`: P v with P = I - n nᵀ.
inline Vector3d TangentPart(const Vector3d& v, const Vector3d& n) { return v - n * n.dot(v); }

/// `v`, shortened to this norm if it is longer.
inline Vector3d LimitNorm(const Vector3d& v, double limit) {
  const double norm = v.norm();
  return norm > limit ? Vector3d(v * (limit / norm)) : v;
}

/// Rotation vector (axis * angle, [rad]) of a rotation, angle in [0, pi].
inline Vector3d RotationVector(const Quaterniond& q_in) {
  Quaterniond q = q_in;
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  if (s < 1e-12) return 2.0 * q.vec();
  return q.vec() * (2.0 * std::atan2(s, q.w()) / s);
}

/// Inverse of RotationVector().
inline Quaterniond FromRotationVector(const Vector3d& r) {
  const double angle = r.norm();
  if (angle < 1e-12) return Quaterniond(1.0, 0.5 * r.x(), 0.5 * r.y(), 0.5 * r.z()).normalized();
  return Quaterniond(Eigen::AngleAxisd(angle, r / angle));
}

}  // namespace regrasp
