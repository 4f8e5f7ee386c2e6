#pragma once

/// The sphere closest to a cloud of points.

#include <optional>
#include <span>

#include "core/common/frames.h"

namespace regrasp {

struct SphereFit {
  Vector3d centre = Vector3d::Zero();  ///< [m]
  double radius = 0;                   ///< [m]
  double rms_error = 0;  ///< root mean square of (distance to the centre - radius) [m]
};

/// Least squares of the radial distances: the algebraic fit [Coope 1993], refined by Gauss-Newton.
/// Nothing for fewer than five points, or where the points do not determine a sphere (all in one
/// plane or point).
std::optional<SphereFit> FitSphere(std::span<const Vector3d> points);

}  // namespace regrasp
