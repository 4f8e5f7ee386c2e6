#include "core/world/articulation.h"

#include <cmath>

namespace regrasp {
namespace {

constexpr double kSamePoint = 1e-9;  // [m]
constexpr double kSquare = 1e-9;     // cosine
constexpr double kOnAxis = 1e-6;     // [m]: 8 g at 1 µm are 1e-7 N m of gravity torque

Matrix3d PointInertia(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

// A mass distribution in the frame of one link.
struct Lump {
  double mass = 0;
  Vector3d p_com = Vector3d::Zero();
  Matrix3d I_com = Matrix3d::Zero();

  void Add(double m, const Vector3d& p, const Matrix3d& I) {
    const double total = mass + m;
    if (total <= 0) return;
    const Vector3d c = (mass * p_com + m * p) / total;
    I_com += PointInertia(mass, p_com - c) + I + PointInertia(m, p - c);
    p_com = c;
    mass = total;
  }
};

// The joint that forms a universal joint with `first`, or -1.
int PartnerOf(const HandModel& hand, int first) {
  const Joint& j1 = hand.joints[first];
  const Link& middle = hand.links[j1.child_link];
  int second = -1;
  for (int k = 0; k < static_cast<int>(hand.joints.size()); ++k) {
    if (hand.joints[k].parent_link != j1.child_link) continue;
    if (second >= 0) return -1;
    second = k;
  }
  if (second < 0 || !middle.shapes.empty()) return -1;
  for (const Finger& finger : hand.fingers)
    if (finger.tip_link == j1.child_link) return -1;
  const Joint& j2 = hand.joints[second];
  if (j2.X_PJ.translation().norm() > kSamePoint) return -1;
  if (std::abs(j1.axis_J.dot(j2.X_PJ.linear() * j2.axis_J)) > kSquare) return -1;
  if (middle.p_LCom.cross(j1.axis_J).norm() > kOnAxis) return -1;
  return second;
}

}  // namespace

Articulation PlanBodies(const HandModel& hand, bool merge) {
  Articulation plan;
  plan.body_of_link.assign(hand.links.size(), -1);
  std::vector<Lump> lumps;
  std::vector<Matrix3d> armatures;
  std::vector<bool> merged(hand.joints.size(), false);

  for (std::size_t l = 1; l < hand.links.size(); ++l) {
    const int i = hand.links[l].parent_joint;
    if (merged[i]) continue;
    const Joint& j1 = hand.joints[i];
    const int second = merge ? PartnerOf(hand, i) : -1;
    const int parent = plan.body_of_link[j1.parent_link];
    JointPlan joint;
    joint.body = static_cast<int>(plan.bodies.size());
    joint.first = i;
    joint.second = second;
    joint.parent_link = j1.parent_link;
    joint.R_PJ = j1.X_PJ.linear();
    joint.axis1_J = j1.axis_J;
    Matrix3d armature = j1.armature * j1.axis_J * j1.axis_J.transpose();
    int link = j1.child_link;
    if (second < 0) {
      joint.zero1_J = RotationFromZ(j1.axis_J).col(0);
      joint.moving1_L = joint.zero1_J;
    } else {
      const Joint& j2 = hand.joints[second];
      const Link& middle = hand.links[j1.child_link];
      merged[second] = true;
      link = j2.child_link;
      plan.body_of_link[j1.child_link] = parent;
      joint.axis2_L = j2.axis_J;
      joint.zero1_J = j2.X_PJ.linear() * j2.axis_J;
      joint.moving1_L = j2.axis_J;
      joint.zero2_L = j2.X_PJ.linear().transpose() * j1.axis_J;
      if (parent >= 0)
        lumps[parent].Add(middle.mass, j1.X_PJ * middle.p_LCom,
                          j1.X_PJ.linear() * middle.I_LCom * j1.X_PJ.linear().transpose());
      const double a1 = j1.armature + j1.axis_J.dot(middle.I_LCom * j1.axis_J);
      const Matrix3d along2 = j2.axis_J * j2.axis_J.transpose();
      armature = j2.armature * along2 + a1 * (Matrix3d::Identity() - along2);
    }
    plan.body_of_link[link] = joint.body;
    BodyPlan body;
    body.link = link;
    body.parent = parent;
    Lump lump;
    lump.Add(hand.links[link].mass, hand.links[link].p_LCom, hand.links[link].I_LCom);
    lumps.push_back(lump);
    armatures.push_back(armature);
    plan.bodies.push_back(body);
    plan.joints.push_back(joint);
  }
  for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
    plan.bodies[b].mass = lumps[b].mass;
    plan.bodies[b].p_LB = lumps[b].p_com;
    plan.bodies[b].I_B = lumps[b].I_com + armatures[b];
  }
  return plan;
}

void JointAngles(const JointPlan& joint, const Matrix3d& R_PL, double* q1, double* q2) {
  const Matrix3d M = joint.R_PJ.transpose() * R_PL;
  const Vector3d moved = M * joint.moving1_L;
  *q1 = std::atan2(joint.axis1_J.dot(joint.zero1_J.cross(moved)), joint.zero1_J.dot(moved));
  if (joint.second < 0) return;
  const Vector3d back = M.transpose() * joint.axis1_J;
  *q2 = -std::atan2(joint.axis2_L.dot(joint.zero2_L.cross(back)), joint.zero2_L.dot(back));
}

}  // namespace regrasp
