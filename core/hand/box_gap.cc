#include "core/hand/box_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace regrasp {
namespace {

void AddBoxes(const Link& link, const Isometry3d& X_WL, Boxes* boxes) {
  for (const Shape& shape : link.shapes)
    if (shape.kind == Shape::Kind::kBox) boxes->push_back({X_WL * shape.X_LB, shape.half_extents});
}

/// How far a box reaches from its centre along the unit vector `n_W` [m].
double Reach(const PlacedBox& box, const Vector3d& n_W) {
  return (box.X_WB.linear().transpose() * n_W).cwiseAbs().dot(box.half_extents);
}

}  // namespace

Boxes BoxesOf(const HandModel& hand, int finger, const FingerPosture& posture) {
  Boxes boxes;
  const Link& last = hand.links[hand.fingers[finger].tip_link];
  AddBoxes(last, posture.X_WT, &boxes);
  const Link& before = hand.links[hand.joints[last.parent_joint].parent_link];
  if (before.parent_joint >= 0) AddBoxes(before, posture.X_WM, &boxes);
  return boxes;
}

double Gap(const PlacedBox& one, const PlacedBox& two) {
  constexpr double kParallel = 1e-6;  // edges whose cross product is shorter give no plane
  const Vector3d way_W = two.X_WB.translation() - one.X_WB.translation();
  const Matrix3d R1 = one.X_WB.linear(), R2 = two.X_WB.linear();
  double widest = -std::numeric_limits<double>::infinity();
  const auto try_plane = [&](const Vector3d& n_W) {
    widest = std::max(widest, std::abs(way_W.dot(n_W)) - Reach(one, n_W) - Reach(two, n_W));
  };
  for (int i = 0; i < 3; ++i) {
    try_plane(R1.col(i));
    try_plane(R2.col(i));
    for (int k = 0; k < 3; ++k) {
      const Vector3d cross = R1.col(i).cross(R2.col(k));
      if (const double norm = cross.norm(); norm > kParallel) try_plane(cross / norm);
    }
  }
  return widest;
}

double Gap(const PlacedBox& box, const Bone& bone) {
  if (bone.radius <= 0) return 1;
  const Isometry3d X_BW = box.X_WB.inverse();
  const Vector3d a = X_BW * bone.a_W, way = X_BW * bone.b_W - a;
  const auto distance = [&](double share) {
    const Vector3d p = a + share * way;
    return (p - p.cwiseMax(-box.half_extents).cwiseMin(box.half_extents)).norm();
  };
  // Convex along the segment: golden section, to 1e-4 of its length.
  constexpr int kSteps = 20;
  constexpr double kGolden = 0.6180339887498949;
  double from = 0, to = 1;
  double left = to - kGolden * (to - from), right = from + kGolden * (to - from);
  double at_left = distance(left), at_right = distance(right);
  for (int k = 0; k < kSteps; ++k) {
    if (at_left < at_right) {
      to = right;
      right = left;
      at_right = at_left;
      left = to - kGolden * (to - from);
      at_left = distance(left);
    } else {
      from = left;
      left = right;
      at_left = at_right;
      right = from + kGolden * (to - from);
      at_right = distance(right);
    }
  }
  return std::min({distance(0), distance(1), at_left, at_right}) - bone.radius;
}

}  // namespace regrasp
