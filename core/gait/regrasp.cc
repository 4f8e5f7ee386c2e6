#include "core/gait/regrasp.h"

#include <algorithm>

#include "core/exploration/walls.h"

namespace regrasp {
namespace {

constexpr int kTouchTicks = 3;      // consecutive ticks of contact that count as landed
constexpr double kNear = 0.0015;    // this near to above the target the finger comes down [m]
constexpr double kLate_s = 0.15;    // it comes down anyway so long after its target got there
constexpr double kTooDeep = 0.010;  // so far below where it left: no surface here [m]
constexpr double kClear = 0.001;    // across: after so far a touch is an obstacle [m]
constexpr double kLost_s = 1.0;     // a finger that reloads without contact for so long is lost
constexpr double kSlideArrived = 0.0005;  // [m]
constexpr double kSlideLimit_s = 2.5;
constexpr double kReturned = 0.0003;    // [m]
constexpr double kRecallLimit_s = 0.6;  // of the slides to the last end and to the best contact
constexpr double kSettle_s = 0.08;
constexpr double kDiscSlack = 0.0005;  // a best contact may be so far beyond the disc [m]
constexpr double kDiscReturn =
    1.0;  // share of the excess over the disc that counts as a wall's depth

/// Unit direction at `from` of the arc to `to` about the origin: the angle and the distance from
/// the origin change in proportion. Zero where they coincide.
Vector3d ArcDirection(const Vector3d& from, const Vector3d& to) {
  constexpr double kNearlyStraight = 0.05;  // rad
  const Vector3d radial = from.normalized();
  const Vector3d across = to - to.dot(radial) * radial;
  const double angle = std::atan2(across.norm(), to.dot(radial));
  if (angle < kNearlyStraight) {
    const Vector3d way = to - from;
    return way.norm() > 1e-9 ? Vector3d(way.normalized()) : Vector3d(Vector3d::Zero());
  }
  const double arc = angle * from.norm();
  return (across.normalized() * arc + radial * (to.norm() - from.norm())).normalized();
}

}  // namespace

std::string_view Name(Regrasp::Phase phase) {
  using Phase = Regrasp::Phase;
  switch (phase) {
    case Phase::kIdle:
      return "idle";
    case Phase::kUnload:
      return "unload";
    case Phase::kLift:
      return "lift";
    case Phase::kAcross:
      return "across";
    case Phase::kDown:
      return "down";
    case Phase::kSlide:
      return "slide";
    case Phase::kSettle:
      return "settle";
    case Phase::kRecall:
      return "recall";
    case Phase::kExplore:
      return "explore";
    case Phase::kReturn:
      return "return";
    case Phase::kReload:
      return "reload";
    case Phase::kDone:
      return "done";
  }
  return "";
}

void Regrasp::Start(const Request& request) {
  *this = Regrasp();
  request_ = request;
  phase_ = Phase::kUnload;
}

void Regrasp::Abort() {
  if (active()) abort_ = aborted_ = true;
}

void Regrasp::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = 0;
  path_ = 0;
}

void Regrasp::Reach(const Vector3d& velocity, double dt, FingerTask* task) {
  p_target_W_ += velocity * dt;
  path_ += velocity.norm() * dt;
  task->mode = FingerMode::kReach;
  task->p_target_W = p_target_W_;
  task->v_target_W = velocity;
}

void Regrasp::Explore(const ControlTick& tick, const Target& target, FingerTask* task) {
  const ExplorationParameters& exploration = tick.exploration;
  const GaitParameters& parameters = tick.gait;
  const double dt = tick.dt;
  const FingerEstimate& finger = tick.finger(request_.finger);
  const ObjectiveValue objective =
      Objective(request_.criterion, request_.finger, tick.grasp.without(request_.without),
                tick.estimate, tick.control, exploration.stability_weight, on_stability_);
  phi_ = objective.phi;
  on_stability_ = objective.on_stability;
  task->mode = FingerMode::kSlide;
  task->force = exploration.normal_force;
  task->v_W.setZero();

  SurfaceExploration::Input input{finger.p_WC, finger.normal_W, phi_, {}};
  FindWalls(tick.hand, tick.estimate, request_.finger, exploration, &input.walls);
  const Vector3d out = TangentPart(finger.p_WC - target.p_WC, finger.normal_W);
  const double excess = out.norm() - request_.disc_share * parameters.disc_radius;
  if (excess > 0) input.walls.push_back({out.normalized(), kDiscReturn * excess, true});

  if (phase_ == Phase::kSettle) {
    if (ticks_ * dt < kSettle_s) return;
    explore_began_ = true;
    best_.Start(finger.p_WC, phi_);
    Enter(Phase::kRecall);
    return;
  }
  const bool lost = finger.ticks_without_contact * dt > 0.1;
  const auto End = [&] {
    explore_ended_ = true;
    Enter(Phase::kReload);
  };
  if (abort_ || lost) return End();
  if (excess < kDiscSlack) best_.Add(finger.p_WC, phi_, dt);
  if (phase_ == Phase::kExplore) {
    const bool over = ticks_ * dt > parameters.explore_s;
    if (!over && algorithm_.Update(input, exploration, dt) == SurfaceExploration::Status::kRunning)
      task->v_W = algorithm_.velocity_W();
    else if (best_.worth_returning() || excess >= kDiscSlack)
      Enter(Phase::kReturn);
    else
      End();
    return;
  }

  const bool recall = phase_ == Phase::kRecall;
  const Vector3d& to = recall ? target.p_WR : best_.p_WC();
  const Vector3d error = TangentPart(to - finger.p_WC, finger.normal_W);
  const double distance = error.norm();
  if (distance >= (recall ? kSlideArrived : kReturned) && ticks_ * dt <= kRecallLimit_s) {
    task->v_W = error * std::min(parameters.slide_gain, parameters.slide_speed / distance);
    for (const Wall& wall : input.walls)
      task->v_W -= std::max(0.0, task->v_W.dot(wall.direction_W)) * wall.direction_W;
  } else if (recall) {
    algorithm_.Start(input, parameters.estimator, request_.seed, 0, exploration);
    if (!request_.gradient_W.isZero()) algorithm_.StartFrom(request_.gradient_W);
    Enter(Phase::kExplore);
  } else {
    End();
  }
}

void Regrasp::Update(const ControlTick& tick, const Target& target, HybridController* controller,
                     FingerTasks* tasks) {
  const ControlParameters& control = tick.control;
  const GaitParameters& parameters = tick.gait;
  const double dt = tick.dt;
  explore_began_ = explore_ended_ = false;
  if (!active()) return;
  const FingerEstimate& finger = tick.finger(request_.finger);
  FingerTask& task = (*tasks)[request_.finger];
  ++ticks_;
  const double ramp = std::min(1.0, ticks_ * dt / std::max(dt, parameters.transfer_s));

  switch (phase_) {
    case Phase::kIdle:
    case Phase::kDone:
      break;

    case Phase::kUnload: {
      // Down from the force it has: above that nothing would be relieved.
      if (ticks_ == 1) cap_start_ = std::min(control.max_normal_force, finger.force);
      const double low = request_.hop ? parameters.hop_force : parameters.slide_force;
      task.mode = FingerMode::kHold;
      task.cap = cap_start_ + ramp * (std::min(low, cap_start_) - cap_start_);
      task.grip = std::min(parameters.grip_force, task.cap);
      if (abort_) {
        Enter(Phase::kReload);
      } else if (ramp >= 1.0) {
        p_target_W_ = finger.p_WF;
        normal_W_ = finger.normal_W;
        Enter(request_.hop ? Phase::kLift : Phase::kSlide);
      }
      break;
    }

    case Phase::kLift:
      Reach(parameters.lift_speed * normal_W_, dt, &task);
      if (abort_) {
        Enter(Phase::kDown);
      } else if (path_ >= parameters.lift_height) {
        Enter(Phase::kAcross);
      }
      break;

    case Phase::kAcross: {
      const Vector3d above = target.p_WF + parameters.lift_height * target.normal_W;
      const double distance = (above - p_target_W_).norm();
      const double speed = std::min(parameters.across_speed, distance / dt);
      Reach(speed * ArcDirection(p_target_W_ - target.p_WO, above - target.p_WO), dt, &task);
      if (distance > 1e-6) ticks_ = 0;  // counts from when the target has arrived
      // Something is in the way: the finger stands where it touches, rather than push the object.
      if (finger.in_contact && finger.ticks_in_contact >= kTouchTicks && path_ > kClear) {
        Enter(Phase::kReload);
        break;
      }
      const bool near = (above - finger.p_WF).norm() < kNear;
      if (abort_ || (distance <= 1e-6 && (near || ticks_ * dt > kLate_s))) {
        normal_W_ = target.normal_W;
        Enter(Phase::kDown);
      }
      break;
    }

    case Phase::kDown:
      Reach(-parameters.down_speed * normal_W_, dt, &task);
      if ((finger.in_contact && finger.ticks_in_contact >= kTouchTicks) ||
          path_ > parameters.lift_height + kTooDeep)
        Enter(request_.explore && !abort_ ? Phase::kSettle : Phase::kReload);
      break;

    case Phase::kSlide: {
      task.mode = FingerMode::kSlide;
      task.force = parameters.slide_force;
      const Vector3d error = TangentPart(target.p_WC - finger.p_WC, finger.normal_W);
      const double distance = error.norm();
      task.v_W =
          distance > 1e-9
              ? Vector3d(error * std::min(parameters.slide_gain, parameters.slide_speed / distance))
              : Vector3d(Vector3d::Zero());
      if (abort_) {
        Enter(Phase::kReload);
      } else if (distance < kSlideArrived || ticks_ * dt > kSlideLimit_s) {
        Enter(request_.explore ? Phase::kSettle : Phase::kReload);
      }
      break;
    }

    case Phase::kSettle:
    case Phase::kRecall:
    case Phase::kExplore:
    case Phase::kReturn:
      Explore(tick, target, &task);
      break;

    case Phase::kReload: {
      const bool touching = finger.in_contact;
      if (ticks_ == 1) {
        cap_start_ = std::max(control.min_normal_force, finger.force);
        if (request_.explore) controller->RestHere(tick.estimate, request_.finger);
      }
      task.mode = FingerMode::kHold;
      const double grip = std::min(parameters.grip_force, control.max_normal_force);
      task.cap = std::max(cap_start_, cap_start_ + ramp * (grip - cap_start_));
      task.grip = std::min(parameters.grip_force, task.cap);
      if (ramp < 1.0) break;
      lost_ = !touching && ticks_ * dt > kLost_s;
      if (!touching && !lost_) break;
      task.cap = control.max_normal_force;
      task.grip = parameters.grip_force;
      Enter(Phase::kDone);
      break;
    }
  }
}

void Regrasp::AddTo(StateHasher* hasher) const {
  hasher->Add(phase_);
  hasher->Add(ticks_);
  if (!active()) return;
  hasher->Add(request_.finger);
  hasher->Add(request_.disc_share);
  hasher->Add(abort_);
  hasher->Add(cap_start_);
  hasher->Add(p_target_W_);
  hasher->Add(normal_W_);
  hasher->Add(path_);
  hasher->Add(phi_);
  hasher->Add(on_stability_);
  best_.AddTo(hasher);
  algorithm_.AddTo(hasher);
}

}  // namespace regrasp
