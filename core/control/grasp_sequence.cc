#include "core/control/grasp_sequence.h"

#include <algorithm>
#include <cmath>

namespace regrasp {
void GraspSequence::Start(const Estimate& estimate) {
  phase_ = Phase::kClose;
  ticks_ = 0;
  progress_ = 0;
  q_start_ = estimate.q;
  touched_.fill(false);
}

void GraspSequence::Update(const ControlTick& tick, const JointVector& q_closed,
                           HybridController* controller, FingerTasks* tasks) {
  const Estimate& estimate = tick.estimate;
  const ControlParameters& parameters = tick.control;
  const int num_fingers = tick.hand.num_fingers();
  tasks->resize(num_fingers);
  ++ticks_;
  const double time = ticks_ * tick.dt;

  if (phase_ == Phase::kClose) {
    const double travel = (q_closed - q_start_).cwiseAbs().maxCoeff();
    const double duration = travel / parameters.close_speed;
    const double s = std::min(1.0, time / duration);
    const auto touch_ticks = std::lround(parameters.touch_s / tick.dt);
    int touched = 0;
    for (int i = 0; i < num_fingers; ++i) {
      const FingerEstimate& f = estimate.fingers[i];
      FingerTask& task = (*tasks)[i];
      if (!touched_[i] && f.in_contact && f.ticks_in_contact >= touch_ticks) touched_[i] = true;
      touched += touched_[i];
      if (touched_[i]) {
        task.mode = FingerMode::kTouch;
        task.force = parameters.close_force;
        continue;
      }
      if (s >= 1.0) {
        const Vector3d way = estimate.p_WO - f.p_WF;
        if (task.mode != FingerMode::kReach) task.p_target_W = f.p_WF;
        task.mode = FingerMode::kReach;
        task.v_target_W = parameters.search_speed * way.normalized();
        task.p_target_W += task.v_target_W * tick.dt;
        continue;
      }
      task.mode = FingerMode::kPosture;
      const std::vector<int>& joints = tick.hand.fingers[i].joints;
      task.q_target.resize(static_cast<Eigen::Index>(joints.size()));
      for (std::size_t k = 0; k < joints.size(); ++k)
        task.q_target[k] = q_start_[joints[k]] + s * (q_closed[joints[k]] - q_start_[joints[k]]);
    }
    progress_ = 0.6 * s;
    const bool all = touched == num_fingers;
    const bool late = time > duration + parameters.search_s;
    if (all || (late && touched >= 3)) {
      phase_ = Phase::kGrip;
      ticks_ = 0;
      controller->StartHolding(estimate, tick.gravity_W, parameters);
    } else if (late) {
      phase_ = Phase::kFailed;
    }
    return;
  }

  const bool gripping = phase_ == Phase::kGrip;
  const double ramp = gripping ? std::min(1.0, time / parameters.grip_ramp_s) : 1.0;
  for (int i = 0; i < num_fingers; ++i) {
    FingerTask& task = (*tasks)[i];
    if (!touched_[i]) {  // stays where its search ended
      task.v_target_W.setZero();
      continue;
    }
    task.mode = FingerMode::kHold;
    task.grip = parameters.close_force + ramp * (parameters.grip_force - parameters.close_force);
    task.cap =
        parameters.close_force + ramp * (parameters.max_normal_force - parameters.close_force);
  }
  if (gripping) {
    progress_ = 0.6 + 0.2 * ramp;
    // The stand-in holds the object: restarting keeps the integrals and the reference from winding
    // up.
    controller->wrench().Start(estimate, tick.gravity_W, parameters);
    if (time > parameters.grip_ramp_s + parameters.stand_in_release_s) {
      phase_ = Phase::kAlone;
      ticks_ = 0;
      for (int i = 0; i < num_fingers; ++i) controller->RestHere(estimate, i);
    }
  } else if (phase_ == Phase::kAlone) {
    progress_ = 0.8 + 0.2 * std::min(1.0, time / parameters.settle_s);
    if (time > parameters.settle_s) phase_ = Phase::kDone;
  }
}

}  // namespace regrasp
