#include "core/exploration/guided_slide.h"

#include <algorithm>

#include "core/exploration/walls.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kTryStride = 0x9e3779b97f4a7c15ULL;  // between the seeds of two tries

}  // namespace

void GuidedSlide::Start(const Request& request) {
  *this = GuidedSlide();
  request_ = request;
  Enter(Phase::kUnload);
}

void GuidedSlide::Land(bool explore) {
  if (phase_ == Phase::kAway) Enter(explore && !stop_ ? Phase::kSettle : Phase::kReload);
}

void GuidedSlide::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = 0;
}

bool GuidedSlide::TryAgain(const SlideProfile& profile,
                           const ExplorationParameters& parameters) const {
  return tries_ + 1 < profile.tries && !Gains(best_.phi(), phi_initial_, parameters.little_gain) &&
         2 * cycles() < MaxCycles(request_.max_cycles, parameters);
}

void GuidedSlide::EndSlide(End end) {
  end_ = end;
  phi_final_ = phi_;
  slide_ended_ = slid_ = true;
  Enter(Phase::kReload);
}

void GuidedSlide::Update(const ControlTick& tick, const SlideProfile& profile,
                         const SlideGuide& guide, HybridController* controller,
                         FingerTasks* tasks) {
  slide_began_ = slide_ended_ = false;
  if (!active() || phase_ == Phase::kAway) return;
  FingerTask& task = (*tasks)[request_.finger];
  ++ticks_;
  if (phase_ == Phase::kUnload) {
    Unload(tick, profile, &task);
  } else if (phase_ == Phase::kReload) {
    if (ticks_ == 1 && slid_) controller->RestHere(tick.estimate, request_.finger);
    Reload(tick, profile, &task);
  } else {
    Slide(tick, profile, guide, controller, &task);
  }
}

void GuidedSlide::Unload(const ControlTick& tick, const SlideProfile& profile, FingerTask* task) {
  const ExplorationParameters& parameters = tick.exploration;
  if (ticks_ == 1) {
    // What the finger drags on the object must stay small against what the others can carry.
    slide_force_ = parameters.normal_force *
                   std::clamp(parameters.force_share * tick.margins.without[request_.finger] /
                                  parameters.normal_force,
                              parameters.least_force, 1.0);
    // Down from the force it has: above that nothing would be relieved.
    cap_start_ = std::min(tick.control.max_normal_force, tick.finger(request_.finger).force);
  }
  const double ramp = std::min(1.0, ticks_ * tick.dt / std::max(tick.dt, profile.transfer_s));
  const double low = std::min(cap_start_, request_.leaves ? profile.leave_force : slide_force_);
  task->mode = FingerMode::kHold;
  task->cap = cap_start_ + ramp * (low - cap_start_);
  task->grip = std::min(profile.grip_force, task->cap);
  if (stop_) {
    Enter(Phase::kReload);
  } else if (ramp >= 1.0) {
    Enter(request_.leaves ? Phase::kAway : Phase::kSettle);
  }
}

void GuidedSlide::Reload(const ControlTick& tick, const SlideProfile& profile, FingerTask* task) {
  const ControlParameters& control = tick.control;
  const FingerEstimate& finger = tick.finger(request_.finger);
  if (ticks_ == 1) cap_start_ = std::max(control.min_normal_force, finger.force);
  const double ramp = std::min(1.0, ticks_ * tick.dt / std::max(tick.dt, profile.transfer_s));
  const double grip = std::min(profile.grip_force, control.max_normal_force);
  task->mode = FingerMode::kHold;
  task->cap = std::max(cap_start_, cap_start_ + ramp * (grip - cap_start_));
  task->grip = std::min(profile.grip_force, task->cap);
  if (ramp < 1.0) return;
  no_surface_ = !finger.in_contact && ticks_ * tick.dt > tick.exploration.reload_limit_s;
  if (!finger.in_contact && !no_surface_) return;
  task->cap = control.max_normal_force;
  task->grip = profile.grip_force;
  Enter(Phase::kDone);
}

SurfaceExploration::Input GuidedSlide::Sense(const ControlTick& tick, const SlideGuide& guide) {
  const FingerEstimate& finger = tick.finger(request_.finger);
  const double margin =
      request_.without < 0 ? tick.margins.all : tick.margins.without[request_.without];
  const ObjectiveValue objective =
      Objective(tick.hand,
                {request_.criterion, request_.finger, tick.grasp.without(request_.without),
                 request_.turn_axis_W, margin},
                tick.estimate, tick.control, tick.exploration, on_stability_);
  phi_ = objective.phi;
  on_stability_ = objective.on_stability;
  SurfaceExploration::Input input{finger.p_WC, finger.normal_W, phi_, {}};
  const bool stays = stays_on_side_ || tick.exploration.onto_tip_s <= 0;
  FindWalls(tick.hand, tick.estimate, request_.finger, tick.exploration,
            stays ? OnSide::kStay : OnSide::kLeave, &input.walls);
  const Vector3d out = TangentPart(finger.p_WC - guide.disc_centre_W, finger.normal_W);
  excess_ = out.norm() - guide.disc_radius;
  if (excess_ > 0) input.walls.push_back({out.normalized(), excess_, Wall::Kind::kMustLeave});
  return input;
}

void GuidedSlide::StartAlgorithm(const SurfaceExploration::Input& input,
                                 const ExplorationParameters& parameters) {
  algorithm_.Start(input, request_.estimator,
                   request_.seed + kTryStride * static_cast<std::uint64_t>(tries_),
                   MaxCycles(request_.max_cycles, parameters) - cycles_before_, parameters);
  if (tries_ == 0 && !request_.gradient_W.isZero()) algorithm_.StartFrom(request_.gradient_W);
  best_.StartWaiting();
  Enter(Phase::kExplore);
}

void GuidedSlide::Slide(const ControlTick& tick, const SlideProfile& profile,
                        const SlideGuide& guide, HybridController* controller, FingerTask* task) {
  const bool was_on_stability = on_stability_;
  const SurfaceExploration::Input input = Sense(tick, guide);
  task->mode = FingerMode::kSlide;
  task->force = slide_force_;
  task->v_W.setZero();

  if (phase_ == Phase::kSettle) {
    if (stop_) {
      slid_ = true;
      Enter(Phase::kReload);
    } else if (ticks_ * tick.dt >= profile.settle_s) {
      slide_began_ = true;
      phi_initial_ = phi_final_ = phi_;
      best_.Start(input.p_WC, phi_);
      if (guide.recall_W) {
        Enter(Phase::kRecall);
      } else {
        StartAlgorithm(input, tick.exploration);
      }
    }
    return;
  }
  if (MustEnd(tick, controller->wrench())) return;

  // Values of another objective do not compare.
  if (on_stability_ != was_on_stability) best_.Start(input.p_WC, phi_);
  if (phase_ != Phase::kReturn) Remember(tick, input);
  if (phase_ == Phase::kExplore) {
    Explore(tick, profile, input, task);
  } else if (phase_ == Phase::kRecall) {
    if (!guide.recall_W || Approach(tick, profile, *guide.recall_W, input, task))
      StartAlgorithm(input, tick.exploration);
  } else if (Approach(tick, profile, best_.p_WC(), input, task)) {
    if (TryAgain(profile, tick.exploration)) {
      cycles_before_ += algorithm_.cycle();
      ++tries_;
      StartAlgorithm(input, tick.exploration);
    } else {
      EndSlide(end_);
    }
  }
}

void GuidedSlide::Remember(const ControlTick& tick, const SurfaceExploration::Input& input) {
  const ExplorationParameters& parameters = tick.exploration;
  const bool blind = std::ranges::any_of(input.walls, &Wall::blind);
  was_on_tip_ = was_on_tip_ || !blind;
  if (!was_on_tip_) {
    best_.Start(input.p_WC, phi_);  // it cannot come back up the side of its link
  } else if (!blind && excess_ < parameters.disc_slack) {
    best_.Add(input.p_WC, phi_, parameters.best_filter_s, parameters.worth_returning, tick.dt);
  }
}

bool GuidedSlide::MustEnd(const ControlTick& tick, const ObjectWrench& wrench) {
  const ExplorationParameters& parameters = tick.exploration;
  if (stop_) {
    EndSlide(End::kNone);
    return true;
  }
  if (tick.finger(request_.finger).ticks_without_contact * tick.dt > parameters.lost_contact_s) {
    EndSlide(End::kContactLost);
    return true;
  }
  const double object_error = (wrench.p_ref() - tick.estimate.p_WO).norm();
  patience_ = std::clamp((parameters.object_stop - object_error) /
                             std::max(1e-9, parameters.object_stop - parameters.object_slow),
                         0.0, 1.0);
  waited_ = patience_ > 0 ? 0 : waited_ + 1;
  if (waited_ * tick.dt <= parameters.object_wait_s) return false;
  EndSlide(End::kObjectMoved);
  return true;
}

void GuidedSlide::Explore(const ControlTick& tick, const SlideProfile& profile,
                          const SurfaceExploration::Input& input, FingerTask* task) {
  using Status = SurfaceExploration::Status;
  const bool keeps_best = InfoOf(request_.estimator).keeps_best;
  const double no_gain_s = tick.exploration.no_gain_s;
  if (ticks_ * tick.dt > profile.explore_s) {
    end_ = End::kTime;
  } else if (keeps_best && no_gain_s > 0 && best_.no_gain_s() > no_gain_s) {
    end_ = End::kNoGain;
  } else {
    const Status status = algorithm_.Update(input, tick.exploration, tick.dt);
    if (status == Status::kRunning) {
      task->v_W = patience_ * algorithm_.velocity_W();
      return;
    }
    if (status == Status::kBlind) {
      stays_on_side_ = true;
      return;
    }
    end_ = status == Status::kConverged ? End::kGradient : End::kMaxCycles;
  }
  const bool back = keeps_best && (best_.worth_returning(tick.exploration.worth_returning) ||
                                   TryAgain(profile, tick.exploration));
  if (back || excess_ >= tick.exploration.disc_slack) {
    Enter(Phase::kReturn);
  } else {
    EndSlide(end_);
  }
}

bool GuidedSlide::Approach(const ControlTick& tick, const SlideProfile& profile, const Vector3d& to,
                           const SurfaceExploration::Input& input, FingerTask* task) {
  const ExplorationParameters& parameters = tick.exploration;
  const Vector3d error = TangentPart(to - input.p_WC, input.normal_W);
  if (error.norm() < parameters.arrived || ticks_ * tick.dt > profile.return_limit_s) return true;
  Vector3d v = SlideTowards(error, parameters.return_gain, parameters.speed_max);
  for (const Wall& wall : input.walls)
    v -= std::max(0.0, v.dot(wall.direction_W)) * wall.direction_W;
  task->v_W = patience_ * v;
  return false;
}

}  // namespace regrasp
