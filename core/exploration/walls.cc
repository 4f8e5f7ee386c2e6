#include "core/exploration/walls.h"

#include <algorithm>

namespace regrasp {
namespace {

/// A link's first capsule in W.
struct Capsule {
  Vector3d a, b;
  double radius = 0;
};

constexpr double kTouching = 1e-6;  // m: nearer axes have no direction between them
constexpr double kLeastRate = 0.2;  // links that near each other more slowly are no wall

bool CapsuleOf(const HandModel& hand, const Estimate& estimate, int link, Capsule* capsule) {
  for (const Shape& shape : hand.links[link].shapes) {
    if (shape.kind != Shape::Kind::kCapsule) continue;
    const Isometry3d& X_WL = estimate.kinematics.X_WL[link];
    *capsule = {X_WL * shape.a_L, X_WL * shape.b_L, shape.radius};
    return true;
  }
  return false;
}

/// Closest points of the axes of two capsules [Ericson 2005, Sec. 5.1.9].
struct Closest {
  Vector3d on_one, on_two;
};
Closest BetweenSegments(const Capsule& one, const Capsule& two) {
  const Vector3d d1 = one.b - one.a, d2 = two.b - two.a, r = one.a - two.a;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  double s = 0, t = 0;
  constexpr double kPoint = 1e-12;  // m²: shorter segments are points
  if (a <= kPoint && e <= kPoint) return {one.a, two.a};
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
  return {one.a + s * d1, two.a + t * d2};
}

/// `direction`: of contact motion, any length; `depth` [m] along it.
void AddWall(const Vector3d& direction, double depth, const Vector3d& normal,
             FixedVector<Wall, 8>* walls, bool must_leave = false) {
  const Vector3d tangent = TangentPart(direction, normal);
  const double share = tangent.norm() / direction.norm();
  if (share > 0.2) walls->push_back({tangent.normalized(), depth / share, must_leave});
}

}  // namespace

void FindWalls(const HandModel& hand, const Estimate& estimate, int finger,
               const ExplorationParameters& parameters, FixedVector<Wall, 8>* walls) {
  walls->clear();
  const FingerEstimate& f = estimate.fingers[finger];
  const Finger& model = hand.fingers[finger];
  const Matrix3d inverse =
      (f.J * f.J.transpose() + 1e-6 * Matrix3d::Identity()).inverse();  // 1 mm damping
  for (std::size_t k = 0; k < model.joints.size(); ++k) {
    const Joint& joint = hand.joints[model.joints[k]];
    const double q = estimate.q[model.joints[k]];
    const Vector3d row = inverse * f.J.col(static_cast<Eigen::Index>(k));  // d q_k / d v
    const double above = q - (joint.upper - parameters.limit_margin);
    const double below = joint.lower + parameters.limit_margin - q;
    if (above > 0) AddWall(row, above / row.norm(), f.normal_W, walls);
    if (below > 0) AddWall(-row, below / row.norm(), f.normal_W, walls);
  }
  Capsule own, other;
  if (CapsuleOf(hand, estimate, model.tip_link, &own) && (own.b - own.a).norm() > 1e-6) {
    // The contact must stay on the round end: on the side of the link it no longer follows the tip.
    // facing = d . n is negative there (d: along the link, n: outward normal); its rate of change
    // with the contact velocity v is (w x d) . n + d . v / (R + r), with w the link's angular
    // velocity.
    const Vector3d d = (own.b - own.a).normalized();
    const Vector3d& n = f.normal_W;
    const double facing = d.dot(n);
    if (facing > parameters.least_facing) {
      Vector3d rate = d / (estimate.object_scale + own.radius);
      for (std::size_t k = 0; k < model.joints.size(); ++k) {
        const Vector3d row = inverse * f.J.col(static_cast<Eigen::Index>(k));
        const Vector3d turn =
            AngularRate(hand, estimate.kinematics, model.joints[k], model.tip_link);
        rate += turn.cross(d).dot(n) * row;
      }
      constexpr bool kMustLeave = true;  // the finger would roll off over the side of its link
      AddWall(rate, (facing - parameters.least_facing) / rate.norm(), n, walls, kMustLeave);
    }
  }
  const auto Before = [&](int link) {
    return hand.joints[hand.links[link].parent_joint].parent_link;
  };
  for (int own_link : {model.tip_link, Before(model.tip_link)}) {
    if (!CapsuleOf(hand, estimate, own_link, &own)) continue;
    for (int i = 0; i < hand.num_fingers(); ++i) {
      const int tip = hand.fingers[i].tip_link;
      if (i == finger) continue;
      for (int link : {tip, Before(tip)}) {
        if (!CapsuleOf(hand, estimate, link, &other)) continue;
        const Closest closest = BetweenSegments(own, other);
        const Vector3d between = closest.on_two - closest.on_one;
        const double distance = between.norm();
        const double depth = own.radius + other.radius + parameters.clearance - distance;
        if (depth <= 0 || distance < kTouching) continue;
        // How fast the links near each other, per contact velocity: the joints that move the own
        // link, with q' = J⁺ v.
        Vector3d rate = Vector3d::Zero();
        for (std::size_t k = 0; k < model.joints.size(); ++k) {
          const Vector3d v =
              PointRate(hand, estimate.kinematics, model.joints[k], own_link, closest.on_one);
          rate += v.dot(between) / distance * (inverse * f.J.col(static_cast<Eigen::Index>(k)));
        }
        if (rate.norm() > kLeastRate) AddWall(rate, depth / rate.norm(), f.normal_W, walls);
      }
    }
  }
}

}  // namespace regrasp
