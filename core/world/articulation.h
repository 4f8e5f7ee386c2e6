#pragma once

/// How the links and joints of a hand become rigid bodies and constraints. Pure geometry, no ODE.
///
/// Two consecutive joints whose axes are perpendicular and meet in one point are a universal joint:
/// the link between them needs no body of its own, which saves 6 unknowns and 4 constraint rows
/// each. Its mass goes to the parent's body. Its centre of mass must lie on the first axis, so that
/// the gravity load stays exact, and it must have no collision shape.

#include <vector>

#include "core/common/frames.h"
#include "core/common/limits.h"
#include "core/hand/hand_model.h"

namespace regrasp {

/// A rigid body. Its frame B has the axes of its link and its origin at the body's centre of mass.
struct BodyPlan {
  int link = -1;                     ///< the link whose axes and shapes it carries
  int parent = -1;                   ///< parent body, -1 for the static palm
  double mass = 0;                   ///< of the link and what is lumped into it [kg]
  Vector3d p_LB = Vector3d::Zero();  ///< centre of mass in the link frame [m]
  Matrix3d I_B = Matrix3d::Zero();   ///< about the centre of mass, armature included [kg m²]
};

/// A constraint between `body` and its parent: a hinge (second == -1) or a universal joint.
///
/// The armature a of a joint is added to the inertia of the moved body: a u uᵀ for a hinge with
/// axis u. For a universal joint with axes u1, u2 it is a2 u2 u2ᵀ + a1 (I - u2 u2ᵀ), because u1
/// turns in the body as the second joint moves.
struct JointPlan {
  int body = -1;
  int first = -1;                        ///< joint index
  int second = -1;                       ///< joint index, or -1
  int parent_link = -1;                  ///< parent of `first`
  Matrix3d R_PJ = Matrix3d::Identity();  ///< joint frame of `first` in the parent link
  Vector3d axis1_J = Vector3d::UnitX();  ///< first axis in that frame
  Vector3d zero1_J =
      Vector3d::UnitY();  ///< unit, perpendicular to axis1_J; image of `moving1_L` at q1 = 0
  Vector3d moving1_L =
      Vector3d::UnitY();  ///< vector of the child link; q1 is the angle from zero1_J to it
  Vector3d axis2_L = Vector3d::UnitX();  ///< universal: second axis in the child link
  Vector3d zero2_L = Vector3d::UnitY();  ///< universal: axis1 in the child link at q2 = 0
};

struct Articulation {
  std::vector<BodyPlan> bodies;   ///< parents before children
  std::vector<JointPlan> joints;  ///< joints[i] moves bodies[i]
  std::vector<int> body_of_link;  ///< -1 for links that are part of the static palm
};

/// Plans the bodies of a hand. `merge`: use universal joints where possible.
Articulation PlanBodies(const HandModel& hand, bool merge);

/// Angles of a joint from the rotation of the child link in the parent link, each in (-pi, pi]
/// [rad]. q2 is set only for a universal joint.
void JointAngles(const JointPlan& joint, const Matrix3d& R_PL, double* q1, double* q2);

}  // namespace regrasp
