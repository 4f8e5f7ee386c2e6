#include "core/hand/kinematics.h"

#include <cassert>

namespace regrasp {

void ForwardKinematics(const HandModel& model, const JointVector& q, KinematicsData* data) {
  assert(q.size() == model.num_joints());
  data->X_WL[0].setIdentity();
  for (std::size_t l = 1; l < model.links.size(); ++l) {
    const int j = model.links[l].parent_joint;
    const Joint& joint = model.joints[j];
    const double angle = joint.driver < 0 ? q[j] : joint.ratio * q[joint.driver] + joint.offset;
    const Isometry3d X_WJ = data->X_WL[joint.parent_link] * joint.X_PJ;
    data->axis_W[j] = X_WJ.linear() * joint.axis_J;
    data->p_WJ[j] = X_WJ.translation();
    Isometry3d& X_WL = data->X_WL[l];
    X_WL = X_WJ;
    X_WL.linear() = X_WJ.linear() * Eigen::AngleAxisd(angle, joint.axis_J).toRotationMatrix();
  }
}

Vector3d FingertipCentre(const HandModel& model, const KinematicsData& data, int finger) {
  const Finger& f = model.fingers[finger];
  return data.X_WL[f.tip_link] * f.p_LF;
}

Vector3d AngularRate(const HandModel& model, const KinematicsData& data, int driven, int link) {
  Vector3d w_W = Vector3d::Zero();
  for (int j = model.links[link].parent_joint; j >= 0;
       j = model.links[model.joints[j].parent_link].parent_joint) {
    const Joint& joint = model.joints[j];
    if ((joint.driver < 0 ? j : joint.driver) == driven) w_W += joint.ratio * data.axis_W[j];
  }
  return w_W;
}

Vector3d PointRate(const HandModel& model, const KinematicsData& data, int driven, int link,
                   const Vector3d& p_WQ) {
  Vector3d v_W = Vector3d::Zero();
  for (int j = model.links[link].parent_joint; j >= 0;
       j = model.links[model.joints[j].parent_link].parent_joint) {
    const Joint& joint = model.joints[j];
    if ((joint.driver < 0 ? j : joint.driver) == driven)
      v_W += joint.ratio * data.axis_W[j].cross(p_WQ - data.p_WJ[j]);
  }
  return v_W;
}

FingerJacobian PointJacobian(const HandModel& model, const KinematicsData& data, int finger,
                             const Vector3d& p_WQ) {
  const Finger& f = model.fingers[finger];
  FingerJacobian J(3, static_cast<Eigen::Index>(f.joints.size()));
  for (std::size_t k = 0; k < f.joints.size(); ++k)
    J.col(static_cast<Eigen::Index>(k)) = PointRate(model, data, f.joints[k], f.tip_link, p_WQ);
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
  JointVector torque = JointVector::Zero(model.num_joints());
  for (int l = static_cast<int>(model.links.size()) - 1; l > 0; --l) {
    const int j = model.links[l].parent_joint;
    const Joint& joint = model.joints[j];
    torque[joint.driver < 0 ? j : joint.driver] -=
        joint.ratio * data.axis_W[j].dot((moment_W[l] - mass[l] * data.p_WJ[j]).cross(gravity_W));
    mass[joint.parent_link] += mass[l];
    moment_W[joint.parent_link] += moment_W[l];
  }
  return torque;
}

}  // namespace regrasp
