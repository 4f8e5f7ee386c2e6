#include "core/exploration/walls.h"

#include <algorithm>
#include <optional>

#include "core/hand/damped_inverse.h"
#include "core/hand/segment_distance.h"
#include "core/hand/shape_distance.h"

namespace regrasp {
namespace {

/// A link's first capsule in W.
struct Capsule {
  Vector3d a, b;
  double radius = 0;
};

constexpr double kTouching = 1e-6;   // m: nearer axes have no direction between them
constexpr double kLeastShare = 0.2;  // of a direction that is tangential: less is no wall
constexpr double kLeastRate = 0.2;   // what nears, or moves up a side, more slowly is no wall
constexpr double kUpSide = 5e-4;     // m: farther up a contact is on the side of the link

bool CapsuleOf(const HandModel& hand, const Estimate& estimate, int link, Capsule* capsule) {
  for (const Shape& shape : hand.links[link].shapes) {
    if (shape.kind != Shape::Kind::kCapsule) continue;
    const Isometry3d& X_WL = estimate.kinematics.X_WL[link];
    *capsule = {X_WL * shape.a_L, X_WL * shape.b_L, shape.radius};
    return true;
  }
  return false;
}

/// `direction`: of contact motion, any length; `depth` [m] along it. None where the direction is
/// not along the surface.
std::optional<Wall> MakeWall(const Vector3d& direction, double depth, const Vector3d& normal,
                             Wall::Kind kind = Wall::Kind::kMayStay) {
  const Vector3d tangent = TangentPart(direction, normal);
  const double share = tangent.norm() / direction.norm();
  if (!(share > kLeastShare)) return {};
  return Wall{tangent.normalized(), depth / share, kind};
}
/// False where there is none.
bool AddWall(const std::optional<Wall>& wall, Walls* walls) {
  if (wall) walls->push_back(*wall);
  return wall.has_value();
}

/// One finger among the others.
struct Explorer {
  const HandModel& hand;
  const Estimate& estimate;
  const ExplorationParameters& parameters;
  int index;
  const Finger& model;
  const FingerEstimate& finger;
  Matrix3d inverse;  // (J Jᵀ + damping)⁻¹

  /// d q_k / d v, for the contact's velocity v.
  Vector3d JointRate(std::size_t k) const {
    return inverse * finger.J.col(static_cast<Eigen::Index>(k));
  }
  /// The link before this one on its way to the palm.
  int Before(int link) const { return hand.joints[hand.links[link].parent_joint].parent_link; }
};

void AddJointLimits(const Explorer& e, Walls* walls) {
  for (std::size_t k = 0; k < e.model.joints.size(); ++k) {
    const Joint& joint = e.hand.joints[e.model.joints[k]];
    const double q = e.estimate.q[e.model.joints[k]];
    const Vector3d row = e.JointRate(k);
    const double above = q - (joint.upper - e.parameters.limit_margin);
    const double below = joint.lower + e.parameters.limit_margin - q;
    if (above > 0) AddWall(MakeWall(row, above / row.norm(), e.finger.normal_W), walls);
    if (below > 0) AddWall(MakeWall(-row, below / row.norm(), e.finger.normal_W), walls);
  }
}

/// On the side of the link the contact does not follow the tip: a link that slides along itself
/// only changes `up`, how far from the tip's centre it touches. With the object at rest
///   up = (p_F - p_O) . d,   d up / d v = v_F . d + (p_F - p_O) . (w x d)   per contact velocity v.
/// False where the finger cannot move so.
bool AddSide(const Explorer& e, const Capsule& own, const Vector3d& d, double up, Walls* walls) {
  const Vector3d& n = e.finger.normal_W;
  const Vector3d arm = own.b - (e.finger.p_WC - e.estimate.object_scale * n);
  const KinematicsData& links = e.estimate.kinematics;
  const int tip = e.model.tip_link;
  Vector3d rate = Vector3d::Zero();
  for (std::size_t k = 0; k < e.model.joints.size(); ++k) {
    const int joint = e.model.joints[k];
    rate += (PointRate(e.hand, links, joint, tip, own.b).dot(d) +
             AngularRate(e.hand, links, joint, tip).cross(d).dot(arm)) *
            e.JointRate(k);
  }
  return rate.norm() > kLeastRate &&
         AddWall(MakeWall(rate, up / rate.norm(), n, Wall::Kind::kBlind), walls);
}

/// The contact must stay on the round end. facing = d . n is negative there (d: along the link, n:
/// outward normal); its rate of change with the contact velocity v is
///   (w x d) . n + d . v / (R + r),   with w the link's angular velocity.
void AddTipSide(const Explorer& e, OnSide on_side, Walls* walls) {
  Capsule own;
  if (!CapsuleOf(e.hand, e.estimate, e.model.tip_link, &own) || (own.b - own.a).norm() <= 1e-6)
    return;
  const Vector3d d = (own.b - own.a).normalized();
  const Vector3d& n = e.finger.normal_W;
  const double facing = d.dot(n), up = (own.b - e.finger.p_WC).dot(d);
  if (facing <= e.parameters.least_facing) return;
  if (on_side == OnSide::kLeave && up > kUpSide && AddSide(e, own, d, up, walls)) return;
  Vector3d rate = d / (e.estimate.object_scale + own.radius);
  for (std::size_t k = 0; k < e.model.joints.size(); ++k)
    rate += AngularRate(e.hand, e.estimate.kinematics, e.model.joints[k], e.model.tip_link)
                .cross(d)
                .dot(n) *
            e.JointRate(k);
  // The finger would roll off over the side of its link.
  AddWall(
      MakeWall(rate, (facing - e.parameters.least_facing) / rate.norm(), n, Wall::Kind::kMustLeave),
      walls);
}

/// Between `on_W`, a point of a link of this finger, and one `between` away that rests. `depth`:
/// how much too near they are [m].
std::optional<Wall> WallTo(const Explorer& e, int own_link, const Vector3d& on_W,
                           const Vector3d& between, double depth) {
  const double distance = between.norm();
  if (depth <= 0 || distance < kTouching) return {};
  // How fast they near each other, per contact velocity: the joints that move the own link, with
  // q' = J⁺ v.
  Vector3d rate = Vector3d::Zero();
  for (std::size_t k = 0; k < e.model.joints.size(); ++k) {
    const Vector3d v = PointRate(e.hand, e.estimate.kinematics, e.model.joints[k], own_link, on_W);
    rate += v.dot(between) / distance * e.JointRate(k);
  }
  if (rate.norm() <= kLeastRate) return {};
  return MakeWall(rate, depth / rate.norm(), e.finger.normal_W);
}

/// Between a link of this finger and another finger's.
void AddLinks(const Explorer& e, int own_link, const Capsule& own, const Capsule& other,
              Walls* walls) {
  const SegmentPoints closest = ClosestOfSegments(own.a, own.b, other.a, other.b);
  const Vector3d between = closest.on_two - closest.on_one;
  AddWall(WallTo(e, own_link, closest.on_one, between,
                 own.radius + other.radius + e.parameters.clearance - between.norm()),
          walls);
}

/// Between the object and what the last link has beside its fingertip: what touches there is not
/// felt. The object stands for a ball that touches the fingertip where it is felt, as large as the
/// grasp. The deepest wall of all these shapes.
void AddBody(const Explorer& e, Walls* walls) {
  const double radius = e.estimate.object_scale;
  const Vector3d centre = e.finger.p_WC - radius * e.finger.normal_W;
  const Isometry3d& X_WL = e.estimate.kinematics.X_WL[e.model.tip_link];
  const auto& shapes = e.hand.links[e.model.tip_link].shapes;
  std::optional<Wall> deepest;
  for (std::size_t k = 1; k < shapes.size(); ++k) {  // the first is the fingertip
    const Nearest nearest = NearestOf(shapes[k], X_WL, centre);
    const Vector3d between = centre - nearest.on_W;
    const std::optional<Wall> wall =
        WallTo(e, e.model.tip_link, nearest.on_W, between,
               nearest.radius + radius + e.parameters.clearance - between.norm());
    if (wall && (!deepest || wall->depth > deepest->depth)) deepest = wall;
  }
  AddWall(deepest, walls);
}

void AddOtherFingers(const Explorer& e, Walls* walls) {
  Capsule own, other;
  for (int own_link : {e.model.tip_link, e.Before(e.model.tip_link)}) {
    if (!CapsuleOf(e.hand, e.estimate, own_link, &own)) continue;
    for (int i = 0; i < e.hand.num_fingers(); ++i) {
      if (i == e.index) continue;
      const int tip = e.hand.fingers[i].tip_link;
      for (int link : {tip, e.Before(tip)})
        if (CapsuleOf(e.hand, e.estimate, link, &other)) AddLinks(e, own_link, own, other, walls);
    }
  }
}

}  // namespace

void FindWalls(const HandModel& hand, const Estimate& estimate, int finger,
               const ExplorationParameters& parameters, OnSide on_side, Walls* walls) {
  walls->clear();
  const FingerEstimate& f = estimate.fingers[finger];
  const Explorer explorer{hand, estimate,          parameters, finger, hand.fingers[finger],
                          f,    DampedInverse(f.J)};
  AddJointLimits(explorer, walls);
  AddTipSide(explorer, on_side, walls);
  AddBody(explorer, walls);
  AddOtherFingers(explorer, walls);
}

}  // namespace regrasp
