#include "core/exploration/walls.h"

#include <algorithm>

namespace regrasp {
namespace {

/// A link's first capsule in W.
struct Capsule {
  Vector3d a, b;
  double radius = 0;
};

bool CapsuleOf(const HandModel& hand, const Estimate& estimate, int link, Capsule* capsule) {
  for (const Shape& shape : hand.links[link].shapes) {
    if (shape.kind != Shape::Kind::kCapsule) continue;
    const Isometry3d& X_WL = estimate.kinematics.X_WL[link];
    *capsule = {X_WL * shape.a_L, X_WL * shape.b_L, shape.radius};
    return true;
  }
  return false;
}

/// Closest points of two segments [Ericson 2005, Sec. 5.1.9]; returns from the first to the second.
Vector3d BetweenSegments(const Capsule& one, const Capsule& two) {
  const Vector3d d1 = one.b - one.a, d2 = two.b - two.a, r = one.a - two.a;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  double s = 0, t = 0;
  constexpr double kPoint = 1e-12;  // m²: shorter segments are points
  if (a <= kPoint && e <= kPoint) return -r;
  if (a <= kPoint) {
    t = std::clamp(f / e, 0.0, 1.0);
  } else {
    const double c = d1.dot(r);
    if (e <= kPoint) {
      s = std::clamp(-c / a, 0.0, 1.0);
    } else {
      const double b = d1.dot(d2), denominator = a * e - b * b;
      if (denominator > 1e-18) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
      t = (b * s + f) / e;
      if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = std::clamp((b * t - c) / a, 0.0, 1.0);
      }
    }
  }
  return (two.a + t * d2) - (one.a + s * d1);
}

void AddWall(const Vector3d& direction, const Vector3d& normal, FixedVector<Vector3d, 8>* walls_W) {
  const Vector3d tangent = TangentPart(direction, normal);
  if (tangent.norm() > 0.2 * direction.norm() && direction.norm() > 0)
    walls_W->push_back(tangent.normalized());
}

}  // namespace

void FindWalls(const HandModel& hand, const Estimate& estimate, int finger,
               const ExplorationParameters& parameters, FixedVector<Vector3d, 8>* walls_W) {
  walls_W->clear();
  const FingerEstimate& f = estimate.fingers[finger];
  const Finger& model = hand.fingers[finger];
  const Matrix3d inverse =
      (f.J * f.J.transpose() + 1e-6 * Matrix3d::Identity()).inverse();  // 1 mm damping
  for (std::size_t k = 0; k < model.joints.size(); ++k) {
    const Joint& joint = hand.joints[model.joints[k]];
    const double q = estimate.q[model.joints[k]];
    const Vector3d row = inverse * f.J.col(static_cast<Eigen::Index>(k));  // d q_k / d v
    if (q > joint.upper - parameters.limit_margin) AddWall(row, f.normal_W, walls_W);
    if (q < joint.lower + parameters.limit_margin) AddWall(-row, f.normal_W, walls_W);
  }
  Capsule own, other;
  if (!CapsuleOf(hand, estimate, model.tip_link, &own)) return;
  for (int i = 0; i < hand.num_fingers(); ++i) {
    if (i == finger) continue;
    const int tip = hand.fingers[i].tip_link;
    const int before_tip = hand.joints[hand.links[tip].parent_joint].parent_link;
    for (int link : {tip, before_tip}) {
      if (!CapsuleOf(hand, estimate, link, &other)) continue;
      const Vector3d between = BetweenSegments(own, other);
      if (between.norm() < own.radius + other.radius + parameters.clearance)
        AddWall(between, f.normal_W, walls_W);
    }
  }
}

}  // namespace regrasp
