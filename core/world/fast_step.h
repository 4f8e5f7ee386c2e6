#pragma once

/// The fast step: the equations that dWorldStep solves (the same bodies, soft contacts and friction
/// pyramid, semi-implicit Euler), in joint coordinates. The joints cannot come apart, and what is
/// left to solve are the contact rows, to convergence. Used only inside core/world.

#include <array>

#include "core/common/fixed_vector.h"
#include "core/world/collision.h"
#include "core/world/contact_solver.h"
#include "core/world/hand_dynamics.h"
#include "core/world/world.h"

namespace regrasp {

class FastStep {
 public:
  /// `following`: how coupled joints follow (HandDynamics).
  FastStep(const HandModel& hand, const Articulation& articulation, const ObjectModel& object,
           const WorldConfig& config, const std::vector<Following>& following);

  /// What acts during one step, besides the contacts.
  struct Load {
    JointVector torque;   ///< drives, damping and stops [N m]
    JointVector damping;  ///< and so much more, at the rates after the step [N m s/rad]
    Vector3d push_W = Vector3d::Zero();     ///< on the object [N]
    Vector3d gravity_W = Vector3d::Zero();  ///< [m/s²]
    double friction = 0;
    double mass = 0;    ///< of the object [kg]
    bool held = false;  ///< the stand-in holds the object where it is
  };

  /// Poses of the links at the joint angles `q` [rad], without a step.
  const KinematicsData& SetPosture(const JointVector& q);

  /// Advances `state` by dt: q, qdot, the object's pose and velocity, and the forces of its
  /// contacts, which must be those of `hits` with the forces of the last step as a first guess.
  /// Call SetPosture(state.q) before the first. Returns the poses of the links after the step.
  const KinematicsData& Advance(const Load& load,
                                const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
                                const FixedVector<LinkHit, kMaxLinkHits>& link_hits,
                                WorldState* state);
  /// Sweeps of the contact solver in the last step.
  int sweeps() const { return sweeps_; }

 private:
  static constexpr int kMaxRows = 3 * kMaxObjectContacts + kMaxLinkHits;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  void FreeMotion(const Load& load, const WorldState& state);
  void MakeObjectRows(const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
                      const WorldState& state);
  void MakeLinkRows(const FixedVector<LinkHit, kMaxLinkHits>& hits, int first);
  void FillMatrix();
  void Integrate(WorldState* state);

  const ObjectModel& object_;
  WorldConfig config_;
  HandDynamics dynamics_;
  double contact_softness_, contact_erp_;

  JointVector rate_;  // of the joints, before contact forces, then after
  Vector3d v_, w_;    // of the object, likewise
  Matrix3d R_WO_;
  double root_mass_inverse_ = 0;   // 1/sqrt(m), 0 while the object is held
  Matrix3d root_inertia_inverse_;  // C⁻¹ R_WOᵀ with I_O = C Cᵀ, 0 while the object is held
  ContactSolver<kMaxRows> solver_;
  std::array<HandDynamics::Row, kMaxRows> hand_rows_;
  std::array<Vector6d, kMaxRows> object_rows_;
  std::array<std::array<Vector3d, 3>, kMaxObjectContacts> axes_W_;
  int object_row_count_ = 0;
  int sweeps_ = 0;
};

}  // namespace regrasp
