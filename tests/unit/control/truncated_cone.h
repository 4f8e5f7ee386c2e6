#pragma once

/// What the tests of contact forces share.

#include <algorithm>

#include "core/common/frames.h"
#include "core/common/random.h"
#include "core/control/contact_force_qp.h"

namespace regrasp {

inline Vector3d RandomDirection(RandomStream* random) { return random->Normal3().normalized(); }

inline double Uniform(RandomStream* random, double low, double high) {
  return low + (high - low) * random->Uniform();
}

/// The largest value of g . x over the truncated cone. A linear function is largest at an end of
/// the normal range, with the tangential part as long as the cone allows: an exact oracle that
/// knows nothing of projections.
inline double SupportOfTruncatedCone(const Vector3d& g, const Vector3d& axis, double mu,
                                     double lower, double cap) {
  const double tangential = (g - g.dot(axis) * axis).norm();
  const double per_newton = g.dot(axis) + mu * tangential;
  return std::max(lower * per_newton, cap * per_newton);
}

/// How far `f` is outside the truncated cone [N].
inline double Violation(const Vector3d& f, const Vector3d& axis, double mu, double lower,
                        double cap) {
  const double n = f.dot(axis), t = (f - n * axis).norm();
  return std::max({t - mu * n, lower - n, n - cap, 0.0});
}

}  // namespace regrasp
