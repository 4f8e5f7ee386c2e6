#pragma once

/// How a held object moves, from the fingertips that hold it: where a fingertip neither slides nor
/// lets go, its contact point moves with the object.

#include <span>

#include "core/common/frames.h"

namespace regrasp {

/// A point of the object and how it moved.
struct MovedPoint {
  Vector3d p_W;   ///< [m]
  Vector3d dp_W;  ///< [m]
};

/// A small rigid motion: the point p moves by dp + turn x (p - about).
struct RigidStep {
  Vector3d about_W = Vector3d::Zero();  ///< [m]
  Vector3d dp_W = Vector3d::Zero();     ///< [m]
  Vector3d turn_W = Vector3d::Zero();   ///< rotation vector [rad]
  Vector3d At(const Vector3d& p_W) const { return dp_W + turn_W.cross(p_W - about_W); }
};

/// The rigid motion that fits the points best (least squares, linear in the motion). About axes
/// that they leave open, as two points do about their line, it does not turn. No motion without
/// points.
RigidStep FitStep(std::span<const MovedPoint> points);

}  // namespace regrasp
