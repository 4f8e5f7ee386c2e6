#include "core/hand/kinematics.h"

#include <cassert>

namespace regrasp {

void ForwardKinematics(const HandModel& model, const JointVector& q, KinematicsData* data) {
  assert(q.size() == model.num_joints());
  data->X_WL[0].setIdentity();
  for (int j = 0; j < model.num_joints(); ++j) {
    const Joint& joint = model.joints[j];
    const Isometry3d X_WJ = data->X_WL[joint.parent_link] * joint.X_PJ;
    data->axis_W[j] = X_WJ.linear() * joint.axis_J;
    data->p_WJ[j] = X_WJ.translation();
    Isometry3d& X_WL = data->X_WL[joint.child_link];
    X_WL = X_WJ;
    X_WL.linear() = X_WJ.linear() * Eigen::AngleAxisd(q[j], joint.axis_J).toRotationMatrix();
  }
}

Vector3d FingertipCentre(const HandModel& model, const KinematicsData& data, int finger) {
  const Finger& f = model.fingers[finger];
  return data.X_WL[f.tip_link] * f.p_LF;
}

FingerJacobian PointJacobian(const HandModel& model, const KinematicsData& data, int finger,
                             const Vector3d& p_WQ) {
  const std::vector<int>& joints = model.fingers[finger].joints;
  FingerJacobian J(3, static_cast<Eigen::Index>(joints.size()));
  for (std::size_t k = 0; k < joints.size(); ++k)
    J.col(static_cast<Eigen::Index>(k)) = data.axis_W[joints[k]].cross(p_WQ - data.p_WJ[joints[k]]);
  return J;
}

JointVector GravityTorque(const HandModel& model, const KinematicsData& data,
                          const Vector3d& gravity_W) {
  // Mass and first moment of everything a joint moves, gathered from the tips towards the palm.
  std::array<double, kMaxLinks> mass;
  std::array<Vector3d, kMaxLinks> moment_W;
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    mass[l] = model.links[l].mass;
    moment_W[l] = mass[l] * (data.X_WL[l] * model.links[l].p_LCom);
  }
  JointVector torque(model.num_joints());
  for (int j = model.num_joints() - 1; j >= 0; --j) {
    const Joint& joint = model.joints[j];
    const int l = joint.child_link;
    torque[j] = -data.axis_W[j].dot((moment_W[l] - mass[l] * data.p_WJ[j]).cross(gravity_W));
    mass[joint.parent_link] += mass[l];
    moment_W[joint.parent_link] += moment_W[l];
  }
  return torque;
}

}  // namespace regrasp
