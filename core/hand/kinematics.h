#pragma once

/// Forward kinematics and Jacobians of the fingers. algorithm(model, data): the model never
/// changes, the data is preallocated.

#include <array>

#include "core/common/frames.h"
#include "core/common/limits.h"
#include "core/hand/hand_model.h"

namespace regrasp {

/// What forward kinematics computes from joint angles.
struct KinematicsData {
  std::array<Isometry3d, kMaxLinks> X_WL{};   ///< pose of every link
  std::array<Vector3d, kMaxJoints> axis_W{};  ///< unit axis of every joint, coupled ones too
  std::array<Vector3d, kMaxJoints> p_WJ{};  ///< a point on the axis of every joint: its origin [m]
};

/// Fills `data` for the joint angles `q` [rad, model order].
void ForwardKinematics(const HandModel& model, const JointVector& q, KinematicsData* data);

/// Centre of the fingertip's rounding sphere in W [m].
Vector3d FingertipCentre(const HandModel& model, const KinematicsData& data, int finger);

/// How a link turns [rad/s] and how its point p_WQ [m] moves [m/s] per [rad/s] of the driven joint
/// `driven`, which may move it through coupled joints too; zero where it does not move it.
Vector3d AngularRate(const HandModel& model, const KinematicsData& data, int driven, int link);
Vector3d PointRate(const HandModel& model, const KinematicsData& data, int driven, int link,
                   const Vector3d& p_WQ);

/// Translational Jacobian of the point `p_WQ` [m] that moves with the finger's tip link: 3 x n,
/// columns root to tip: v_WQ = J qdot_finger, [m/s] per [rad/s].
FingerJacobian PointJacobian(const HandModel& model, const KinematicsData& data, int finger,
                             const Vector3d& p_WQ);

/// Joint torques [N m, model order] that hold the links against gravity `gravity_W` [m/s²]:
/// tau_i = - sum over links moved by i of axis_i . ((p_com - p_i) x m g); what a coupled joint
/// bears goes to its driver, times its ratio.
JointVector GravityTorque(const HandModel& model, const KinematicsData& data,
                          const Vector3d& gravity_W);

}  // namespace regrasp
