#include "core/exploration/finger_exploration.h"

#include <algorithm>

#include "core/exploration/walls.h"

namespace regrasp {
namespace {

constexpr double kSettle_s = 0.15;
constexpr double kLittleGain = 1.02;
constexpr int kMaxTries = 3;
constexpr double kReturnGain = 8.0;  // 1/s
constexpr double kReturned_m = 0.0002;
constexpr double kReturnLimit_s = 2.5;
constexpr double kForceShare = 0.5;
constexpr double kLeastForce = 0.5;  // of exploration.normal_force
constexpr double kObjectError_m =
    0.002;  // the finger slows down beyond this error of the object ...
constexpr double kObjectStop_m = 0.003;  // ... and waits beyond this one
constexpr double kWait_s = 0.3;          // waiting for so long ends the exploration
constexpr double kLost_s = 0.30;         // sliding without contact for so long ends the exploration

int MaxCycles(const FingerExploration::Request& request, const ExplorationParameters& parameters) {
  return request.max_cycles > 0 ? request.max_cycles : parameters.max_cycles;
}

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

bool FingerExploration::TryAgain(const ExplorationParameters& parameters) const {
  return tries_ + 1 < kMaxTries && best_.phi() < kLittleGain * phi_initial_ &&
         2 * cycles() < MaxCycles(request_, parameters);
}

void FingerExploration::EndSlide(const Estimate& estimate, HybridController* controller) {
  phi_final_ = phi_;
  slide_ended_ = true;
  stop_ = false;
  controller->RestHere(estimate, request_.finger);
  EnterPhase(Phase::kReload);
}

void FingerExploration::Update(const ControlTick& tick, HybridController* controller,
                               FingerTasks* tasks) {
  const Estimate& estimate = tick.estimate;
  const ControlParameters& control = tick.control;
  const ExplorationParameters& parameters = tick.exploration;
  const double dt = tick.dt;
  slide_began_ = slide_ended_ = false;
  if (phase_ == Phase::kIdle || phase_ == Phase::kDone) return;
  const FingerEstimate& finger = estimate.fingers[request_.finger];
  FingerTask& task = (*tasks)[request_.finger];
  if (phase_ == Phase::kUnload && ticks_ == 0) {
    // What the finger drags on the object must stay small against what the others can carry.
    slide_force_ = std::clamp(kForceShare * tick.margins.without[request_.finger],
                              kLeastForce * parameters.normal_force, parameters.normal_force);
  }
  const double ramp = std::min(1.0, ++ticks_ * dt / std::max(dt, parameters.transfer_s));

  if (phase_ == Phase::kUnload || phase_ == Phase::kReload) {
    const double share = phase_ == Phase::kUnload ? 1.0 - ramp : ramp;
    task.mode = FingerMode::kHold;
    // While unloading the cap comes down from the grip force: above it nothing would be relieved.
    const double top = share < 1.0 ? control.grip_force : control.max_normal_force;
    task.cap = slide_force_ + share * (top - slide_force_);
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
      Objective(request_.criterion, request_.finger, tick.grasp, estimate, control,
                parameters.stability_weight, on_stability_);
  phi_ = objective.phi;
  on_stability_ = objective.on_stability;
  task.mode = FingerMode::kSlide;
  task.force = slide_force_;
  task.v_W.setZero();
  SurfaceExploration::Input input{finger.p_WC, finger.normal_W, phi_, {}};
  FindWalls(tick.hand, estimate, request_.finger, parameters, &input.walls);

  if (phase_ == Phase::kSettle) {
    if (stop_) {
      EnterPhase(Phase::kReload);
      stop_ = false;
    } else if (ticks_ * dt >= kSettle_s) {
      EnterPhase(Phase::kSlide);
      phi_initial_ = phi_final_ = phi_;
      best_.Start(finger.p_WC, phi_);
      slide_began_ = true;
      algorithm_.Start(input, request_.estimator, request_.seed, request_.max_cycles, parameters);
    }
    return;
  }

  if (finger.ticks_without_contact * dt > kLost_s) end_ = End::kContactLost;
  if (end_ == End::kContactLost || stop_) {
    EndSlide(estimate, controller);
    return;
  }
  const double object_error = (controller->wrench().p_ref() - estimate.p_WO).norm();
  const double patience =
      std::clamp((kObjectStop_m - object_error) / (kObjectStop_m - kObjectError_m), 0.0, 1.0);
  waited_ = patience > 0 ? 0 : waited_ + 1;
  if (waited_ * dt > kWait_s) {
    end_ = End::kObjectMoved;
    EndSlide(estimate, controller);
    return;
  }
  if (phase_ == Phase::kReturn) {
    const Vector3d error = TangentPart(best_.p_WC() - finger.p_WC, finger.normal_W);
    const double distance = error.norm();
    if (distance < kReturned_m || ticks_ * dt > kReturnLimit_s) {
      if (TryAgain(parameters)) {
        cycles_before_ += algorithm_.cycle();
        algorithm_.Start(input, request_.estimator,
                         request_.seed + 0x9e3779b97f4a7c15ULL * ++tries_,
                         MaxCycles(request_, parameters) - cycles_before_, parameters);
        end_ = End::kNone;
        EnterPhase(Phase::kSlide);
      } else {
        EndSlide(estimate, controller);
      }
    } else {
      task.v_W =
          patience * error * (std::min(parameters.speed_max, kReturnGain * distance) / distance);
    }
    return;
  }

  best_.Add(finger.p_WC, phi_, dt);
  const SurfaceExploration::Status status = algorithm_.Update(input, parameters, dt);
  if (status == SurfaceExploration::Status::kRunning) {
    task.v_W = patience * algorithm_.velocity_W();
    return;
  }
  end_ = status == SurfaceExploration::Status::kConverged ? End::kGradient : End::kMaxCycles;
  if (request_.estimator == Estimator::kLeastSquares &&
      (best_.worth_returning() || TryAgain(parameters))) {
    EnterPhase(Phase::kReturn);
  } else {
    EndSlide(estimate, controller);
  }
}

void FingerExploration::AddTo(StateHasher* hasher) const {
  hasher->Add(phase_);
  hasher->Add(ticks_);
  hasher->Add(stop_);
  if (phase_ == Phase::kIdle || phase_ == Phase::kDone) return;
  hasher->Add(request_.finger);
  hasher->Add(request_.criterion);
  hasher->Add(on_stability_);
  hasher->Add(slide_force_);
  hasher->Add(waited_);
  hasher->Add(tries_);
  hasher->Add(cycles_before_);
  hasher->Add(phi_initial_);
  best_.AddTo(hasher);
  algorithm_.AddTo(hasher);
}

}  // namespace regrasp
