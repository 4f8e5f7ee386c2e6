#include "core/hand/shape_distance.h"

#include <algorithm>

namespace regrasp {

Nearest NearestOf(const Shape& shape, const Isometry3d& X_WL, const Vector3d& p_W) {
  if (shape.kind == Shape::Kind::kCapsule) {
    const Vector3d a_W = X_WL * shape.a_L, d = X_WL * shape.b_L - a_W;
    const double share = d.dot(p_W - a_W) / std::max(1e-18, d.squaredNorm());
    return {a_W + std::clamp(share, 0.0, 1.0) * d, shape.radius};
  }
  const Isometry3d X_WB = X_WL * shape.X_LB;
  const Vector3d p_B = X_WB.inverse() * p_W;
  return {X_WB * p_B.cwiseMax(-shape.half_extents).cwiseMin(shape.half_extents).eval()};
}

double GapBesideTip(const Link& last, const Isometry3d& X_WL, const Vector3d& centre_W,
                    double radius, double most) {
  double gap = most;
  for (std::size_t k = 1; k < last.shapes.size(); ++k) {  // the first is the fingertip
    const Nearest nearest = NearestOf(last.shapes[k], X_WL, centre_W);
    gap = std::min(gap, (nearest.on_W - centre_W).norm() - nearest.radius - radius);
  }
  return gap;
}

}  // namespace regrasp
