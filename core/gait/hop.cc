#include "core/gait/hop.h"

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr double kThere = 1e-6;  // m: nearer than this a moving target has arrived

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

bool Touches(const ControlTick& tick, const FingerEstimate& finger) {
  return finger.in_contact && finger.ticks_in_contact >= Ticks(tick.gait.touch_s, tick.dt);
}

}  // namespace

void Hop::Start(const FingerEstimate& finger) {
  *this = Hop();
  p_target_W_ = finger.p_WF;
  normal_W_ = finger.normal_W;
  Enter(Phase::kLift);
}

void Hop::Enter(Phase phase) {
  phase_ = phase;
  path_ = 0;
}

void Hop::Reach(const Vector3d& velocity, double dt, FingerTask* task) {
  p_target_W_ += velocity * dt;
  path_ += velocity.norm() * dt;
  task->mode = FingerMode::kReach;
  task->p_target_W = p_target_W_;
  task->v_target_W = velocity;
}

void Hop::Update(const ControlTick& tick, const FingerEstimate& finger, const Target& target,
                 bool down, FingerTask* task) {
  const GaitParameters& parameters = tick.gait;
  if (phase_ == Phase::kLift) {
    Reach(parameters.lift_speed * normal_W_, tick.dt, task);
    if (down) {
      Enter(Phase::kDown);
    } else if (path_ >= parameters.lift_height) {
      Enter(Phase::kAcross);
    }
  } else if (phase_ == Phase::kAcross) {
    Across(tick, finger, target, down, task);
  } else if (phase_ == Phase::kDown) {
    Reach(-parameters.down_speed * normal_W_, tick.dt, task);
    if (Touches(tick, finger) || path_ > parameters.lift_height + parameters.land_depth)
      Enter(Phase::kLanded);
  }
}

void Hop::Across(const ControlTick& tick, const FingerEstimate& finger, const Target& target,
                 bool down, FingerTask* task) {
  const GaitParameters& parameters = tick.gait;
  const Vector3d above = target.p_WF + parameters.lift_height * target.normal_W;
  const double distance = (above - p_target_W_).norm();
  const double speed = std::min(parameters.across_speed, distance / tick.dt);
  Reach(speed * ArcDirection(p_target_W_ - target.p_WO, above - target.p_WO), tick.dt, task);
  late_ticks_ = distance > kThere ? 0 : late_ticks_ + 1;
  // Something is in the way: the finger stands where it touches, rather than push the object.
  if (Touches(tick, finger) && path_ > parameters.clear_distance) {
    Enter(Phase::kBlocked);
    return;
  }
  const bool near = (above - finger.p_WF).norm() < parameters.land_distance;
  const bool late = late_ticks_ * tick.dt > parameters.land_late_s;
  if (down || (distance <= kThere && (near || late))) {
    normal_W_ = target.normal_W;
    Enter(Phase::kDown);
  }
}

}  // namespace regrasp
