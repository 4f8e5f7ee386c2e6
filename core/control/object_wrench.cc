#include "core/control/object_wrench.h"

namespace regrasp {
void ObjectWrench::Start(const Estimate& estimate, const Vector3d& gravity_W,
                         const ControlParameters& parameters) {
  p_ref_ = estimate.p_WO;
  q_ref_ = estimate.q_WO;
  force_start_ = force_integral_ = force_ = -parameters.mass_estimate * gravity_W;
  torque_integral_ = torque_ = Vector3d::Zero();
}

void ObjectWrench::Move(const Vector3d& v_W, const Vector3d& w_W, double dt) {
  p_ref_ += v_W * dt;
  q_ref_ = (FromRotationVector(w_W * dt) * q_ref_).normalized();
}

void ObjectWrench::Update(const Estimate& estimate, const ControlParameters& parameters, double dt,
                          bool freeze) {
  const Vector3d e_p = LimitNorm(p_ref_ - estimate.p_WO, parameters.position_error_limit);
  const Vector3d e_r = LimitNorm(RotationVector(q_ref_ * estimate.q_WO.conjugate()),
                                 parameters.rotation_error_limit);
  if (!freeze) {
    const Vector3d f_box = Vector3d::Constant(parameters.force_integral_limit);
    const Vector3d t_box = Vector3d::Constant(parameters.torque_integral_limit);
    force_integral_ += parameters.position_integral * dt * e_p;
    force_integral_ = force_integral_.cwiseMax(force_start_ - f_box).cwiseMin(force_start_ + f_box);
    torque_integral_ += parameters.rotation_integral * dt * e_r;
    torque_integral_ = torque_integral_.cwiseMax(-t_box).cwiseMin(t_box);
  }
  force_ = force_integral_ + parameters.position_stiffness * e_p;
  torque_ = torque_integral_ + parameters.rotation_stiffness * e_r;
}

}  // namespace regrasp
