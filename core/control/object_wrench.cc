#include "core/control/object_wrench.h"

#include <algorithm>

namespace regrasp {
void ObjectWrench::Start(const Estimate& estimate, const Vector3d& gravity_W,
                         const ControlParameters& parameters) {
  p_ref_ = estimate.p_WO;
  q_ref_ = estimate.q_WO;
  force_start_ = force_integral_ = force_ = -parameters.mass_estimate * gravity_W;
  torque_integral_ = torque_ = Vector3d::Zero();
  mass_ = parameters.mass_estimate;
  share_ = 1;
}

void ObjectWrench::Move(const Vector3d& v_W, const Vector3d& w_W, double dt) {
  p_ref_ += v_W * dt;
  q_ref_ = (FromRotationVector(w_W * dt) * q_ref_).normalized();
}

void ObjectWrench::Update(const Estimate& estimate, const Vector3d& gravity_W,
                          const ControlParameters& parameters, double dt, bool missed) {
  const Vector3d e_p = LimitNorm(p_ref_ - estimate.p_WO, parameters.position_error_limit);
  const Vector3d e_r = LimitNorm(RotationVector(q_ref_ * estimate.q_WO.conjugate()),
                                 parameters.rotation_error_limit);
  if (!missed) {
    const Vector3d f_box = Vector3d::Constant(parameters.force_integral_limit);
    const Vector3d t_box = Vector3d::Constant(parameters.torque_integral_limit);
    force_integral_ += parameters.position_integral * dt * e_p;
    force_integral_ = force_integral_.cwiseMax(force_start_ - f_box).cwiseMin(force_start_ + f_box);
    torque_integral_ += parameters.rotation_integral * dt * e_r;
    torque_integral_ = torque_integral_.cwiseMax(-t_box).cwiseMin(t_box);
  }
  force_ = force_integral_ + parameters.position_stiffness * e_p;
  torque_ = torque_integral_ + parameters.rotation_stiffness * e_r;
  if (parameters.yield_s > 0) Yield(gravity_W, parameters, dt, missed);
}

void ObjectWrench::Yield(const Vector3d& gravity_W, const ControlParameters& parameters, double dt,
                         bool missed) {
  share_ += missed ? -dt / parameters.yield_s : dt / parameters.resume_s;
  share_ = std::clamp(share_, 0.0, 1.0);
  if (share_ == 1 && gravity_W.norm() > 1)
    mass_ += dt / (parameters.mass_filter_s + dt) *
             (std::max(0.0, -force_.dot(gravity_W) / gravity_W.squaredNorm()) - mass_);
  force_ = (1 - share_) * -mass_ * gravity_W + share_ * force_;
  torque_ *= share_;
}

}  // namespace regrasp
