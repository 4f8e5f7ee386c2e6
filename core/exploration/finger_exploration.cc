#include "core/exploration/finger_exploration.h"

#include <algorithm>

#include "core/exploration/walls.h"

namespace regrasp {
namespace {

constexpr double kSettle_s = 0.15;
constexpr double kLost_s = 0.30;  // sliding without contact for so long ends the exploration

}  // namespace

void FingerExploration::Start(const Request& request) {
  *this = FingerExploration();
  request_ = request;
  phase_ = Phase::kUnload;
}

void FingerExploration::Stop() { stop_ = true; }

void FingerExploration::EnterPhase(Phase phase) {
  phase_ = phase;
  ticks_ = 0;
}

void FingerExploration::Update(const HandModel& hand, const Estimate& estimate, unsigned grasp,
                               const ControlParameters& control,
                               const ExplorationParameters& parameters, double dt,
                               HybridController* controller, FingerTasks* tasks) {
  slide_began_ = slide_ended_ = false;
  if (phase_ == Phase::kIdle || phase_ == Phase::kDone) return;
  const FingerEstimate& finger = estimate.fingers[request_.finger];
  FingerTask& task = (*tasks)[request_.finger];
  const double ramp = std::min(1.0, ++ticks_ * dt / std::max(dt, parameters.transfer_s));

  if (phase_ == Phase::kUnload || phase_ == Phase::kReload) {
    const double share = phase_ == Phase::kUnload ? 1.0 - ramp : ramp;
    task.mode = FingerMode::kHold;
    // While unloading the cap comes down from the grip force: above it nothing would be relieved.
    const double top = share < 1.0 ? control.grip_force : control.max_normal_force;
    task.cap = parameters.normal_force + share * (top - parameters.normal_force);
    task.grip = std::min(control.grip_force, task.cap);
    if (ramp >= 1.0 || stop_) {
      if (phase_ == Phase::kReload || stop_) {
        task.cap = control.max_normal_force;
        task.grip = control.grip_force;
        EnterPhase(Phase::kDone);
      } else {
        EnterPhase(Phase::kSettle);
      }
    }
    return;
  }

  const ObjectiveValue objective =
      Objective(request_.criterion, request_.finger, grasp, estimate, control,
                parameters.stability_weight, on_stability_);
  phi_ = objective.phi;
  on_stability_ = objective.on_stability;
  task.mode = FingerMode::kSlide;
  task.force = parameters.normal_force;
  task.v_W.setZero();
  SurfaceExploration::Input input{finger.p_WC, finger.normal_W, phi_, {}};
  FindWalls(hand, estimate, request_.finger, parameters, &input.walls);

  if (phase_ == Phase::kSettle) {
    if (stop_) {
      EnterPhase(Phase::kReload);
      stop_ = false;
    } else if (ticks_ * dt >= kSettle_s) {
      EnterPhase(Phase::kSlide);
      phi_initial_ = phi_final_ = phi_;
      slide_began_ = true;
      algorithm_.Start(input, request_.estimator, request_.seed, request_.max_cycles, parameters);
    }
    return;
  }

  const SurfaceExploration::Status status = algorithm_.Update(input, parameters, dt);
  if (status == SurfaceExploration::Status::kConverged) {
    end_ = End::kGradient;
  } else if (status == SurfaceExploration::Status::kMaxCycles) {
    end_ = End::kMaxCycles;
  } else if (finger.ticks_without_contact * dt > kLost_s) {
    end_ = End::kContactLost;
  }
  if (end_ == End::kNone && !stop_) {
    task.v_W = algorithm_.velocity_W();
    return;
  }
  phi_final_ = phi_;
  slide_ended_ = true;
  stop_ = false;
  controller->RestHere(estimate, request_.finger);
  EnterPhase(Phase::kReload);
}

void FingerExploration::AddTo(StateHasher* hasher) const {
  hasher->Add(phase_);
  hasher->Add(ticks_);
  hasher->Add(stop_);
  if (phase_ == Phase::kIdle || phase_ == Phase::kDone) return;
  hasher->Add(request_.finger);
  hasher->Add(request_.criterion);
  hasher->Add(on_stability_);
  hasher->Add(phi_initial_);
  algorithm_.AddTo(hasher);
}

}  // namespace regrasp
