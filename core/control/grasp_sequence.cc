#include "core/control/grasp_sequence.h"

#include <algorithm>
#include <cmath>

#include "core/hand/finger_reach.h"

namespace regrasp {
namespace {

constexpr int kSteps = 20;              // of the inverse kinematics
constexpr double kRestWindow_s = 0.35;  // over which the sensed object is averaged

}  // namespace

void GraspSequence::Start(const ControlTick& tick, const JointVector& q_closed,
                          const Vector3d& p_WO_expected) {
  phase_ = Phase::kClose;
  ticks_ = 0;
  progress_ = 0;
  q_start_ = tick.estimate.q;
  q_closed_ = q_closed;
  const Vector3d way = tick.control.follow_object * (tick.estimate.p_WO - p_WO_expected);
  for (int i = 0; i < tick.hand.num_fingers() && !way.isZero(); ++i) {
    const FingerPosture closed = PostureAt(tick.hand, i, AnglesOf(tick.hand, i, q_closed));
    const FingerPosture moved = ReachFor(tick.hand, i, closed, closed.p_WF + way, 0, kSteps);
    for (std::size_t k = 0; k < tick.hand.fingers[i].joints.size(); ++k)
      q_closed_[tick.hand.fingers[i].joints[k]] = moved.q[static_cast<Eigen::Index>(k)];
  }
  touched_.fill(false);
  drift_ = Drift();
}

void GraspSequence::Watch(const ControlTick& tick) {
  drift_.sum += tick.estimate.p_WO;
  if (++drift_.ticks * tick.dt < kRestWindow_s) return;
  const Vector3d mean = drift_.sum / drift_.ticks;
  drift_.sum.setZero();
  drift_.ticks = 0;
  if (drift_.windows++ == 0) {
    drift_.first = mean;
  } else {
    // Against the first one the noise of the pose counts less and less.
    drift_.speed =
        std::min((mean - drift_.last).norm(), (mean - drift_.first).norm() / (drift_.windows - 1)) /
        kRestWindow_s;
    drift_.path += (mean - drift_.last).norm();
  }
  drift_.last = mean;
}

void GraspSequence::Update(const ControlTick& tick, HybridController* controller,
                           FingerTasks* tasks) {
  const Estimate& estimate = tick.estimate;
  const ControlParameters& parameters = tick.control;
  const int num_fingers = tick.hand.num_fingers();
  tasks->resize(num_fingers);
  ++ticks_;
  const double time = ticks_ * tick.dt;

  if (phase_ == Phase::kClose) {
    const double travel = (q_closed_ - q_start_).cwiseAbs().maxCoeff();
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
        task.q_target[k] = q_start_[joints[k]] + s * (q_closed_[joints[k]] - q_start_[joints[k]]);
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
    Watch(tick);
    if (time <= parameters.settle_s) return;
    const bool known = drift_.windows > 1;
    if (parameters.rest_speed == 0 || (known && drift_.speed <= parameters.rest_speed))
      phase_ = Phase::kDone;
    else if (known && time > parameters.settle_s + parameters.rest_s)
      phase_ = drift_.directed() ? Phase::kRestless : Phase::kDone;
  }
}

}  // namespace regrasp
