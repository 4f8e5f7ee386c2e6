#pragma once

/// One physics engine holding the scene of bench_peers: a hand around an object, joint torques in,
/// what is to be measured out.

#include <memory>
#include <vector>

#include "core/hand/scenario.h"

namespace regrasp::bench {

/// A fingertip's contact with the object.
struct Touch {
  int finger = -1;
  Vector3d p_W = Vector3d::Zero();  ///< [m]
  double normal_force = 0;          ///< [N]
};

class Engine {
 public:
  virtual ~Engine() = default;
  /// Advances by 1 ms with these joint torques [N m]; `held`: the object stays where it is.
  virtual void Step(const JointVector& torque, bool held) = 0;
  virtual const JointVector& q() const = 0;  ///< [rad]
  virtual Vector3d p_WO() const = 0;         ///< [m]
  virtual Quaterniond q_WO() const = 0;
  virtual std::vector<Touch> touches() const = 0;
  virtual double joint_drift() const = 0;  ///< largest gap between the two sides of a joint [m]
};

/// MuJoCo as it comes: Newton, pyramidal cone, its own contact model; links do not touch each
/// other.
std::unique_ptr<Engine> MakeMujoco(const LoadedScenario& model, const JointVector& q0,
                                   const Isometry3d& X_WO, const Vector3d& gravity_W);

/// Bullet's multi-body (Featherstone) world as it comes; links do not touch each other. Takes the
/// diagonal of inertias, and the armature as inertia of the link.
std::unique_ptr<Engine> MakeBullet(const LoadedScenario& model, const JointVector& q0,
                                   const Isometry3d& X_WO, const Vector3d& gravity_W);

}  // namespace regrasp::bench
