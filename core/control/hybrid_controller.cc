#include "core/control/hybrid_controller.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/hand/damped_inverse.h"

namespace regrasp {
namespace {

/// Damped pseudo-inverse J⁺ = Jᵀ (J Jᵀ + lambda² I)⁻¹, n x 3.
using FingerPinv = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMaxFingerJoints, 3>;
FingerPinv DampedPinv(const FingerJacobian& J, double lambda) {
  const Matrix3d inverse = DampedInverse(J, lambda * lambda);
  return J.transpose() * inverse;
}

/// Force on the fingertip of a reaching finger: a spring to its target, as strong as when sliding.
Vector3d ReachForce(const FingerEstimate& finger, const FingerTask& task,
                    const ControlParameters& parameters) {
  const double reach = parameters.slide_force_limit / parameters.slide_stiffness;
  return parameters.slide_stiffness * LimitNorm(task.p_target_W - finger.p_WF, reach);
}

/// What the object feels of the force that a sliding finger is asked for: friction bounds the
/// tangential part.
Vector3d SlideForceOnObject(const FingerEstimate& finger, const FingerTask& task,
                            const Vector3d& commanded, const ControlParameters& parameters) {
  const Vector3d tangential = TangentPart(commanded, finger.normal_W);
  const double drag = parameters.slide_friction_share * task.force;
  return -task.force * finger.normal_W + LimitNorm(tangential, drag);
}

/// Springs to the resting posture and away from joint limits [N m].
FingerVector PostureTorque(const HandModel& hand, const std::vector<int>& joints,
                           const JointVector& q, const JointVector& q_rest,
                           const ControlParameters& parameters) {
  const int n = static_cast<int>(joints.size());
  FingerVector posture(n);
  for (int k = 0; k < n; ++k) {
    const int j = joints[k];
    const Joint& joint = hand.joints[j];
    posture[k] = parameters.posture_stiffness * (q_rest[j] - q[j]);
    const double below = joint.lower + parameters.limit_margin - q[j];
    const double above = q[j] - (joint.upper - parameters.limit_margin);
    if (below > 0) posture[k] += parameters.limit_stiffness * below;
    if (above > 0) posture[k] -= parameters.limit_stiffness * above;
  }
  return posture;
}

/// Joint torques of a finger [N m] that is asked for the force `commanded` and whose contact moves
/// with `v_ref` [m/s]; the posture acts in the null space of the force.
FingerVector ForceTorque(const HandModel& hand, const std::vector<int>& joints,
                         const FingerEstimate& finger, const FingerVector& posture,
                         const Vector3d& commanded, const Vector3d& v_ref,
                         const ControlParameters& parameters) {
  const FingerVector qdot_ref = DampedPinv(finger.J, parameters.pinv_damping) * v_ref;
  const Vector3d along = finger.J * posture;
  FingerVector tau = finger.J.transpose() * commanded + posture -
                     DampedPinv(finger.J, parameters.projection_damping) * along;
  for (int k = 0; k < static_cast<int>(joints.size()); ++k)
    tau[k] += hand.joints[joints[k]].damping * qdot_ref[k];
  return tau;
}

}  // namespace

HybridController::HybridController(const HandModel& hand, double dt) : hand_(&hand), dt_(dt) {
  torque_ = JointVector::Zero(hand.num_joints());
  q_rest_ = JointVector::Zero(hand.num_joints());
  commanded_.resize(hand.fingers.size());
  for (Vector3d& f : commanded_) f.setZero();
}

void HybridController::StartHolding(const Estimate& estimate, const Vector3d& gravity_W,
                                    const ControlParameters& parameters) {
  wrench_.Start(estimate, gravity_W, parameters);
  qp_.Reset();
  q_rest_ = estimate.q;
}

void HybridController::RestHere(const Estimate& estimate, int finger) {
  for (int j : hand_->fingers[finger].joints) q_rest_[j] = estimate.q[j];
}

Vector3d HybridController::SlideForce(const FingerEstimate& finger, const FingerTask& task,
                                      const Vector3d& v_surface,
                                      const ControlParameters& parameters, FingerState* state) {
  state->p_ref_W += (task.v_W + v_surface) * dt_;
  const double reach = parameters.slide_force_limit / parameters.slide_stiffness;
  const Vector3d error =
      LimitNorm(TangentPart(state->p_ref_W - finger.p_WF, finger.normal_W), reach);
  state->p_ref_W = finger.p_WF + error;  // forgets the normal part, and what is out of reach
  if (finger.in_contact) {
    state->normal_integral += parameters.normal_force_integral * dt_ * (task.force - finger.force);
    state->normal_integral =
        std::clamp(state->normal_integral, -0.5 * task.force, 0.5 * task.force);
  }
  const double normal_force = task.force + state->normal_integral;
  // Friction is overcome by feedforward; the spring about the reference only corrects.
  const Vector3d v = TangentPart(task.v_W, finger.normal_W);
  const Vector3d friction =
      parameters.slide_friction_share * task.force * v / (v.norm() + parameters.slide_slow_speed);
  return friction + parameters.slide_stiffness * error - normal_force * finger.normal_W;
}

const JointVector& HybridController::Update(const Estimate& estimate, const FingerTasks& tasks,
                                            const ObjectMotion& motion, const Vector3d& gravity_W,
                                            const ControlParameters& parameters) {
  const int num_fingers = hand_->num_fingers();
  const double reapproach_ticks = parameters.reapproach_delay_s / dt_;
  torque_ = GravityTorque(*hand_, estimate.kinematics, gravity_W);
  problem_.contacts.clear();
  Vector3d carried_force = Vector3d::Zero(), carried_torque = Vector3d::Zero();
  std::array<Vector3d, kMaxFingers> v_ref;  // wanted velocity of the contact point
  bool holding = false;

  for (int i = 0; i < num_fingers; ++i) {
    const FingerEstimate& f = estimate.fingers[i];
    const FingerTask& task = tasks[i];
    FingerState& state = states_[i];
    if (state.mode != task.mode) {
      state.mode = task.mode;
      state.p_ref_W = f.p_WF;
      state.normal_integral = 0;
    }
    commanded_[i].setZero();
    const Vector3d r = f.p_WC - estimate.p_WO;
    const Vector3d v_surface = motion.v_W + motion.w_W.cross(r);
    v_ref[i] = v_surface;
    const bool moves_in = f.ticks_without_contact > reapproach_ticks;
    switch (task.mode) {
      case FingerMode::kPosture:
        break;
      case FingerMode::kTouch:
        commanded_[i] = -task.force * f.normal_W;
        if (moves_in) v_ref[i] -= parameters.reapproach_speed * f.normal_W;
        break;
      case FingerMode::kHold:
        holding = true;
        if (moves_in) {
          commanded_[i] = -parameters.reapproach_force * f.normal_W;
          v_ref[i] -= parameters.reapproach_speed * f.normal_W;
        } else {
          problem_.contacts.push_back({i, r, -f.normal_W, task.cap, std::min(task.grip, task.cap)});
        }
        break;
      case FingerMode::kSlide: {
        commanded_[i] = SlideForce(f, task, v_surface, parameters, &state);
        v_ref[i] += task.v_W;
        if (moves_in) {
          v_ref[i] -= parameters.reapproach_speed * f.normal_W;
        } else {
          const Vector3d on_object = SlideForceOnObject(f, task, commanded_[i], parameters);
          carried_force += on_object;
          carried_torque += r.cross(on_object);
        }
        break;
      }
      case FingerMode::kReach:
        commanded_[i] = ReachForce(f, task, parameters);
        v_ref[i] = task.v_target_W;
        break;
    }
  }

  if (holding) {
    wrench_.Move(motion.v_W, motion.w_W, dt_);
    wrench_.Update(estimate, gravity_W, parameters, dt_,
                   qp_.residual() > parameters.residual_limit);
    problem_.force = wrench_.force() - carried_force;
    problem_.torque = wrench_.torque() - carried_torque;
    problem_.torque_scale = estimate.object_scale;
    problem_.grip_weight = parameters.grip_weight;
    problem_.mu = parameters.friction_estimate;
    problem_.lower = parameters.min_normal_force;
    const auto& forces = qp_.Solve(problem_);
    for (std::size_t k = 0; k < forces.size(); ++k)
      commanded_[problem_.contacts[k].finger] = forces[k];
  }

  for (int i = 0; i < num_fingers; ++i) {
    const std::vector<int>& joints = hand_->fingers[i].joints;
    const int n = static_cast<int>(joints.size());
    FingerVector tau(n);
    if (tasks[i].mode == FingerMode::kPosture) {
      for (int k = 0; k < n; ++k)
        tau[k] = parameters.free_stiffness * (tasks[i].q_target[k] - estimate.q[joints[k]]);
    } else {
      tau = ForceTorque(*hand_, joints, estimate.fingers[i],
                        PostureTorque(*hand_, joints, estimate.q, q_rest_, parameters),
                        commanded_[i], v_ref[i], parameters);
    }
    for (int k = 0; k < n; ++k) torque_[joints[k]] += tau[k];
  }
  return torque_;
}

}  // namespace regrasp
