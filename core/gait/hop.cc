#include "core/gait/hop.h"

#include <algorithm>
#include <cmath>

#include "core/shape/felt_surface.h"

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

void Hop::Start(const ControlTick& tick, int finger, bool over_surface) {
  *this = Hop();
  const FingerEstimate& f = tick.finger(finger);
  finger_ = finger;
  over_surface_ = over_surface;
  p_target_W_ = f.p_WF;
  normal_W_ = f.normal_W;
  const Quaterniond q_OW = tick.estimate.q_WO.conjugate();
  p_OLeft_ = q_OW * (f.p_WF - tick.estimate.p_WO);
  normal_OLeft_ = q_OW * f.normal_W;
  Enter(Phase::kLift);
}

void Hop::Enter(Phase phase) {
  phase_ = phase;
  path_ = 0;
  ticks_ = 0;
}

void Hop::Reach(const Vector3d& velocity, double dt, FingerTask* task) {
  p_target_W_ += (velocity + v_carried_W_) * dt;
  path_ += velocity.norm() * dt;
  task->mode = FingerMode::kReach;
  task->p_target_W = p_target_W_;
  task->v_target_W = velocity + v_carried_W_;
}

void Hop::KeepAbove(const ControlTick& tick) {
  const Estimate& estimate = tick.estimate;
  const Vector3d r = p_target_W_ - estimate.p_WO;
  const Vector3d d = r.normalized();
  const SurfacePoint surface = tick.felt.At(estimate.q_WO.conjugate() * d);
  const double slope = std::max(tick.gait.least_slope, (estimate.q_WO * surface.normal_O).dot(d));
  const double height =
      tick.hand.fingers[finger_].tip_radius + tick.gait.clear_share * tick.gait.lift_height;
  const double radius = surface.p_O.norm() + std::min(height / slope, height + tick.gait.rise_most);
  const double rise = std::min(radius - r.norm(), tick.gait.across_speed * tick.dt);
  if (rise > 0) p_target_W_ += rise * d;
}

void Hop::Update(const ControlTick& tick, const Target& target, bool down, FingerTask* task) {
  const GaitParameters& parameters = tick.gait;
  ++ticks_;
  v_carried_W_ = target.w_W.cross(p_target_W_ - target.p_WO);
  if (phase_ == Phase::kLift) {
    Reach(parameters.lift_speed * normal_W_, tick.dt, task);
    if (down) {
      Enter(Phase::kDown);
    } else if (path_ >= parameters.lift_height) {
      Enter(Phase::kAcross);
    }
  } else if (phase_ == Phase::kAcross) {
    Across(tick, target, down, task);
  } else if (phase_ == Phase::kDown) {
    Reach(-parameters.down_speed * normal_W_, tick.dt, task);
    if (Touches(tick, tick.finger(finger_)))
      Enter(Phase::kLanded);
    else if (path_ > parameters.lift_height + parameters.land_depth)
      Enter(over_surface_ && !went_back_ ? Phase::kSeek : Phase::kLanded);
  } else if (phase_ == Phase::kSeek) {
    Seek(tick, task);
  } else if (phase_ == Phase::kGoBack) {
    GoBack(tick, task);
  }
}

void Hop::Across(const ControlTick& tick, const Target& target, bool down, FingerTask* task) {
  const GaitParameters& parameters = tick.gait;
  const FingerEstimate& finger = tick.finger(finger_);
  const Vector3d above = target.p_WF + parameters.lift_height * target.normal_W;
  const double distance = (above - p_target_W_).norm();
  const double speed = std::min(parameters.across_speed, distance / tick.dt);
  Reach(speed * ArcDirection(p_target_W_ - target.p_WO, above - target.p_WO), tick.dt, task);
  if (over_surface_ && distance > 2 * parameters.lift_height) KeepAbove(tick);
  const double there = over_surface_ ? parameters.there_on_object : kThere;
  late_ticks_ = distance > there ? 0 : late_ticks_ + 1;
  // Something is in the way: the finger stands where it touches, rather than push the object. One
  // that a joint limit keeps on the surface slides on, to where its joints let it off.
  left_ |= !finger.in_contact;
  if (left_ && Touches(tick, finger) && path_ > parameters.clear_distance) {
    Enter(Phase::kBlocked);
    return;
  }
  const bool near = (above - finger.p_WF).norm() < parameters.land_distance;
  const bool late = late_ticks_ * tick.dt > parameters.land_late_s;
  const bool long_in_air = over_surface_ && ticks_ * tick.dt > tick.gait.air_limit_s;
  if (down || long_in_air || (distance <= there && (near || late))) {
    normal_W_ = target.normal_W;
    const Quaterniond& q_WO = tick.estimate.q_WO;
    if (over_surface_ && distance > parameters.land_distance)
      normal_W_ =
          q_WO * tick.felt.At(q_WO.conjugate() * (finger.p_WF - tick.estimate.p_WO)).normal_O;
    Enter(Phase::kDown);
  }
}

void Hop::Seek(const ControlTick& tick, FingerTask* task) {
  const Vector3d way = tick.estimate.p_WO - p_target_W_;
  Reach(tick.gait.down_speed * way.normalized(), tick.dt, task);
  if (Touches(tick, tick.finger(finger_)))
    Enter(Phase::kLanded);
  else if (path_ > tick.gait.seek_way || way.norm() < tick.hand.fingers[finger_].tip_radius)
    Enter(Phase::kGoBack);
}

void Hop::GoBack(const ControlTick& tick, FingerTask* task) {
  const GaitParameters& parameters = tick.gait;
  const Vector3d& p_WO = tick.estimate.p_WO;
  const Vector3d normal_W = tick.estimate.q_WO * normal_OLeft_;
  const Vector3d above = p_WO + tick.estimate.q_WO * p_OLeft_ + parameters.lift_height * normal_W;
  const double distance = (above - p_target_W_).norm();
  const double speed = std::min(parameters.across_speed, distance / tick.dt);
  went_back_ = true;
  Reach(speed * ArcDirection(p_target_W_ - p_WO, above - p_WO), tick.dt, task);
  KeepAbove(tick);
  if (Touches(tick, tick.finger(finger_)) && path_ > parameters.clear_distance) {
    Enter(Phase::kLanded);
  } else if (distance < parameters.land_distance || ticks_ * tick.dt > tick.gait.air_limit_s) {
    normal_W_ = normal_W;
    Enter(Phase::kDown);
  }
}

}  // namespace regrasp
