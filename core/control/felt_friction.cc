#include "core/control/felt_friction.h"

#include <algorithm>

#include "core/hand/damped_inverse.h"

namespace regrasp {
namespace {

/// Force of a fingertip [N] whose joints, with these torques [N m], of which `weight` bear the
/// hand, and these rates [rad/s], hardly accelerate.
Vector3d TipForce(const HandModel& hand, int finger, const FingerJacobian& J,
                  const JointVector& torque, const JointVector& weight, const JointVector& rate) {
  const std::vector<int>& joints = hand.fingers[static_cast<std::size_t>(finger)].joints;
  Vector3d moment = Vector3d::Zero();
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const int j = joints[k];
    moment += J.col(static_cast<Eigen::Index>(k)) *
              (torque[j] - weight[j] - hand.joints[static_cast<std::size_t>(j)].damping * rate[j]);
  }
  return DampedInverse(J) * moment;
}

}  // namespace

void FeltFriction::Update(const HandModel& hand, const Estimate& estimate, const FingerTasks& tasks,
                          const JointVector& torque, const Vector3d& gravity_W,
                          const ControlParameters& parameters, double dt) {
  const bool known_rate = q_before_.size() == estimate.q.size();
  const JointVector rate =
      known_rate ? JointVector((estimate.q - q_before_) / dt) : JointVector(0 * estimate.q);
  q_before_ = estimate.q;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const FingerEstimate& f = estimate.fingers[i];
    const Vector3d v_W = TangentPart(tasks[i].v_W, f.normal_W);
    const bool slides = tasks[i].mode == FingerMode::kSlide && f.in_contact &&
                        f.force >= parameters.feel_force && v_W.norm() >= parameters.feel_speed;
    sliding_s_[i] = slides ? sliding_s_[i] + dt : 0.0;
    if (sliding_s_[i] < parameters.feel_settled_s) continue;
    const JointVector weight = GravityTorque(hand, estimate.kinematics, gravity_W);
    const Vector3d force = TipForce(hand, static_cast<int>(i), f.J, torque, weight, rate);
    felt_s_ = std::min(parameters.feel_memory_s, felt_s_ + dt);
    mean_ += dt / felt_s_ * (force.dot(v_W.normalized()) / f.force - mean_);
  }
}

double FeltFriction::Counted(double share, const ControlParameters& parameters) const {
  if (!known(parameters)) return parameters.friction_estimate;
  return std::max(parameters.feel_least, std::min(parameters.feel_most, share * mean_));
}

}  // namespace regrasp
