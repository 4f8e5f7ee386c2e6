#pragma once

#include "core/common/fields.h"
#include "core/control/control_parameters.h"
#include "core/control/estimate.h"

namespace regrasp {

/// The wrench the fingers shall exert on the object, about its centre: a PI law on its sensed pose.
///
///   F = F_i + k_p e_p,  dF_i/dt = k_i e_p,  F_i starts at -m g and stays within a box about it
///   T = T_i + k_r e_r,  dT_i/dt = k_j e_r
///
/// e_p, e_r: position error and rotation vector from sensed to reference pose, limited in norm.
///
/// A wrench that the contacts cannot exert leaves them at the edges of their friction cones, with
/// hardly any normal force. So while they miss it the correction yields,
///
///   F -> -m' g + s (F + m' g),  T -> s T,  s from 1 to 0 in control.yield_s, back in resume_s
///
/// down to bearing the weight of the mass m' that was borne lately. The object is then held where
/// the contacts can hold it.
class ObjectWrench {
 public:
  /// Holds the object where it is estimated to be, from a fresh integral.
  void Start(const Estimate& estimate, const Vector3d& gravity_W,
             const ControlParameters& parameters);
  /// New reference, integrals kept.
  void SetReference(const Vector3d& p_WO, const Quaterniond& q_WO) {
    p_ref_ = p_WO;
    q_ref_ = q_WO;
  }
  /// Moves the reference with a velocity [m/s] and angular velocity [rad/s] in W for dt [s].
  void Move(const Vector3d& v_W, const Vector3d& w_W, double dt);
  /// One tick. `missed`: the contact forces miss the wrench of the tick before; the integrals stop
  /// and the correction yields.
  void Update(const Estimate& estimate, const Vector3d& gravity_W,
              const ControlParameters& parameters, double dt, bool missed);

  const Vector3d& force() const { return force_; }    ///< [N]
  const Vector3d& torque() const { return torque_; }  ///< [N m]
  double share() const { return share_; }             ///< s
  const Vector3d& p_ref() const { return p_ref_; }
  const Quaterniond& q_ref() const { return q_ref_; }
  template <typename V>
  void Fields(V& v) {
    v("p_ref", p_ref_);
    v("q_ref", q_ref_);
    v("force_start", force_start_);
    v("force_integral", force_integral_);
    v("torque_integral", torque_integral_);
    v("force", force_);
    v("torque", torque_);
    v("mass", mass_);
    v("share", share_);
  }

 private:
  void Yield(const Vector3d& gravity_W, const ControlParameters& parameters, double dt,
             bool missed);
  Vector3d p_ref_ = Vector3d::Zero();
  Quaterniond q_ref_ = Quaterniond::Identity();
  Vector3d force_start_ = Vector3d::Zero(), force_integral_ = Vector3d::Zero();
  Vector3d torque_integral_ = Vector3d::Zero();
  Vector3d force_ = Vector3d::Zero(), torque_ = Vector3d::Zero();
  double mass_ = 0;   // borne lately [kg]
  double share_ = 1;  // s
};

}  // namespace regrasp
