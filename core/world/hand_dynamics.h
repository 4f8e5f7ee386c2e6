#pragma once

/// Dynamics of the hand in joint coordinates: mass matrix, bias torques, and what a force on a link
/// does to the joint rates. All vectors are expressed in W; moments and velocity fields are taken
/// at its origin, so that bodies add up without any change of frame [Featherstone, Rigid Body
/// Dynamics Algorithms, 2008, chapters 5 to 8].
///
/// Bodies, masses and rotor inertias are those of an Articulation, so that this is the same hand as
/// the one ODE steps.

#include <array>
#include <cstdint>
#include <vector>

#include "core/common/limits.h"
#include "core/hand/hand_model.h"
#include "core/hand/kinematics.h"
#include "core/world/articulation.h"

namespace regrasp {

/// How a joint moves with the driven ones: q = ratio q(driven) + offset [rad].
struct Following {
  int driven = -1;
  double ratio = 1, offset = 0;
};

/// "Joint" below is one of `hand`; where some follow others (`following`, one per joint of `hand`),
/// everything in generalised coordinates, M, b, x, rates of rows, is of the driven joints alone:
/// M := Gᵀ M G, b := Gᵀ b with qdot = G qdot_driven.
class HandDynamics {
 public:
  /// Keeps a reference to `hand`. Without `following` every joint is driven.
  HandDynamics(const HandModel& hand, const Articulation& articulation,
               const std::vector<Following>& following = {});

  /// Gᵀ x: torques of all joints as torques of the driven ones.
  JointVector Fold(const JointVector& torque) const;
  /// The driven joints' share of a vector of all joints.
  JointVector Driven(const JointVector& all) const;
  /// Moves all joints as the driven ones move: q += dt qdot, qdot := G rate; followers stand where
  /// their drivers put them.
  void Move(const JointVector& rate, double dt, JointVector* q, JointVector* qdot) const;

  /// Moves the hand to the joint angles `q` [rad].
  void SetPosture(const JointVector& q);
  const KinematicsData& kinematics() const { return kinematics_; }

  /// Mass matrix M and bias torques b at the present posture, for the joint rates `qdot` [rad/s]
  /// and gravity [m/s²]: M qddot + b = tau. `extra` [kg m²] is added to M's diagonal, joint by
  /// joint: what is taken implicitly. The gyroscopic torque of a link, below 1e-5 N m at
  /// 1 rad/s, is left out, as in the ODE world.
  void Update(const JointVector& qdot, const Vector3d& gravity_W, const JointVector& extra);
  const JointVector& bias() const { return bias_; }

  /// x := M⁻¹ x.
  void Solve(JointVector* x) const;

  /// One scalar constraint on the hand, J qdot. `y` = L⁻ᵀ Jᵀ with M = LᵀL: the dot product of two
  /// such rows is the rate that a unit impulse along one gives the other.
  struct Row {
    std::uint32_t joints = 0;          ///< bit i: joint i takes part
    std::array<double, kMaxJoints> y;  ///< only the entries of `joints` are set
  };
  /// Sets row k to `sign` times the velocity along `axes_W[k]` of the point `p_W` [m] of `link`;
  /// `rate[k]` becomes J qdot [m/s] (`qdot` of the driven joints). The palm gives an empty row and
  /// no rate.
  void MakeRows(int link, const Vector3d& p_W, double sign, const JointVector& qdot, int count,
                const Vector3d* axes_W, Row* rows, double* rate) const;
  /// `a` += `b`, of the same constraint.
  static void Add(const Row& b, Row* a);
  static double Dot(const Row& a, const Row& b);
  /// What an impulse along a row does to the joint rates, before Finish(): impulse += `size` y.
  static void Accumulate(const Row& row, double size, JointVector* impulse);
  /// Turns accumulated impulses into the change of the joint rates: x := L⁻¹ x.
  void Finish(JointVector* x) const;

 private:
  // Inertia of a joint's subtree about the origin of W.
  struct Inertia {
    double mass = 0;
    Vector3d moment = Vector3d::Zero();  // mass times centre [kg m]
    Matrix3d J = Matrix3d::Zero();       // [kg m²]
  };

  void Transpose(std::uint32_t joints, double* x) const;
  void FoldMassMatrix();
  void Factorise();

  const HandModel& hand_;
  int n_;       // joints
  int driven_;  // of them
  std::vector<Following> following_;
  bool folded_;
  std::vector<int> above_;   // driven joints: the next that the factor couples it with, or -1
  std::vector<int> parent_;  // joint that moves the parent link, or -1
  std::vector<int> body_;    // body that a joint carries, or -1
  std::vector<std::uint32_t> chain_;  // the joint and those before it
  std::vector<BodyPlan> bodies_;
  KinematicsData kinematics_;
  JointVector bias_;
  std::array<Vector3d, kMaxJoints> lever_;                // velocity of the origin at unit rate
  Eigen::Matrix<double, kMaxJoints, kMaxJoints> factor_;  // L, below the diagonal and on it
  std::array<double, kMaxJoints> inverse_diagonal_{};
  // Scratch of Update().
  std::array<Vector3d, kMaxJoints> w_, v_, alpha_, a_, force_, torque_;
  std::array<Inertia, kMaxJoints> inertia_;
};

}  // namespace regrasp
