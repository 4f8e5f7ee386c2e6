#include "core/gait/local_manipulation.h"

#include <algorithm>
#include <cassert>

#include "core/hand/damped_inverse.h"

namespace regrasp {
namespace {

constexpr double kThereTurning = 1e-4;   // rad
constexpr double kThereShifting = 1e-5;  // m

}  // namespace

std::string_view Name(LocalManipulation::End end) {
  using End = LocalManipulation::End;
  switch (end) {
    case End::kNone:
      return "moving";
    case End::kReached:
      return "reached";
    case End::kJointLimit:
      return "joint limit";
    case End::kStuck:
      return "the object does not follow";
    case End::kManipulability:
      return "manipulability";
    case End::kExcursion:
      return "excursion";
    case End::kMargin:
      return "load margin";
    case End::kStopped:
      return "stopped";
  }
  return "";
}

void LocalManipulation::Start(const ObjectMotion& per_path, double length, double speed,
                              double acceleration, AtLimit policy) {
  assert(length >= 0);
  *this = LocalManipulation();
  per_path_ = per_path;
  length_ = length;
  speed_max_ = speed;
  acceleration_ = acceleration;
  policy_ = policy;
}

bool LocalManipulation::AtJointLimit(const ControlTick& tick, int finger,
                                     const Vector3d& v_W) const {
  // A joint that moves less than this, per unit of path, may stand at its limit.
  const double least_rate =
      (turns() ? tick.gait.limit_rate : 0.0) + tick.gait.limit_rate_shift * per_path_.v_W.norm();
  const FingerEstimate& f = tick.finger(finger);
  const Vector3d along = DampedInverse(f.J) * v_W;
  const auto& joints = tick.hand.fingers[finger].joints;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const double q = tick.estimate.q[joints[k]];
    const double rate = f.J.col(static_cast<Eigen::Index>(k)).dot(along);
    const Joint& joint = tick.hand.joints[joints[k]];
    if ((q > joint.upper - tick.gait.limit_margin && rate > least_rate) ||
        (q < joint.lower + tick.gait.limit_margin && rate < -least_rate))
      return true;
  }
  return false;
}

Vector3d LocalManipulation::ContactRate(const ControlTick& tick, int finger) const {
  return per_path_.w_W.cross(tick.finger(finger).p_WC - tick.estimate.p_WO) + per_path_.v_W;
}

bool LocalManipulation::HasRoom(const ControlTick& tick, int finger) const {
  const FingerEstimate& f = tick.finger(finger);
  const Vector3d along = DampedInverse(f.J) * ContactRate(tick, finger);
  const auto& joints = tick.hand.fingers[finger].joints;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const Joint& joint = tick.hand.joints[joints[k]];
    const double q = tick.estimate.q[joints[k]];
    const double way = f.J.col(static_cast<Eigen::Index>(k)).dot(along) * (length_ - travelled_);
    if ((way > 0 && q + way > joint.upper - tick.gait.limit_margin) ||
        (way < 0 && q + way < joint.lower + tick.gait.limit_margin))
      return false;
  }
  return true;
}

LocalManipulation::End LocalManipulation::FindEnd(const ControlTick& tick, const Home& home) {
  limited_finger_ = -1;
  for (int i : tick.grasp) {
    const FingerEstimate& f = tick.finger(i);
    end_finger_ = i;
    const Vector3d v = ContactRate(tick, i);
    if (AtJointLimit(tick, i, v)) {
      limited_finger_ = i;
      at_limit_.add(i);
      if (travelled_ == 0) at_limit_at_first_.add(i);
      if (policy_ == AtLimit::kEnds && !at_limit_at_first_.contains(i)) return End::kJointLimit;
    }
    if (f.manipulability < tick.gait.min_manipulability * home.manipulability[i])
      return End::kManipulability;
    const Vector3d excursion = f.p_WC - home.p_WO - home.stance[i].p_OC_W;
    if (excursion.norm() > tick.gait.max_excursion && excursion.dot(v) > 0) return End::kExcursion;
  }
  end_finger_ = -1;
  // On a planned stance the margin counts what is in doubt: it ends a motion that has made it
  // worse.
  const bool far = !tick.gait.plan || travelled_ > tick.gait.margin_counts * length_;
  const double least = tick.gait.margin_min * (tick.gait.plan ? tick.gait.margin_share : 1.0);
  return far && tick.margins.all < least ? End::kMargin : End::kNone;
}

ObjectMotion LocalManipulation::Update(const ControlTick& tick, const ObjectWrench& wrench,
                                       const Home& home) {
  const Estimate& estimate = tick.estimate;
  const double dt = tick.dt;
  ObjectMotion motion;
  if (end_ != End::kNone) return motion;
  const End found = FindEnd(tick, home);
  const double left = length_ - travelled_;
  const double e_p = (wrench.p_ref() - estimate.p_WO).norm();
  const double e_r = RotationVector(wrench.q_ref() * estimate.q_WO.conjugate()).norm();
  const bool wait = e_p > tick.gait.lag_position || e_r > tick.gait.lag_rotation;
  // On a planned stance all the waiting counts: an object that creeps behind is about to slip.
  if (wait)
    ++waited_;
  else if (!tick.gait.plan || policy_ == AtLimit::kYields)
    waited_ = 0;
  double wanted = stop_ || wait ? 0.0 : speed_max_;
  wanted = std::min(wanted, std::sqrt(2.0 * acceleration_ * std::max(0.0, left)));
  const double change = acceleration_ * dt;
  speed_ = std::clamp(wanted, speed_ - change, speed_ + change);
  speed_ = std::min(std::max(speed_, 0.0), left / dt);
  travelled_ += speed_ * dt;
  motion.v_W = speed_ * per_path_.v_W;
  motion.w_W = speed_ * per_path_.w_W;
  const double there =
      std::min(turns() ? kThereTurning : kThereShifting, kThereShifting / per_path_.v_W.norm());
  if (length_ - travelled_ < there) {
    end_ = End::kReached;
  } else if (stop_ && speed_ <= 0) {
    end_ = End::kStopped;
  } else {
    const double patience =
        policy_ == AtLimit::kYields ? tick.gait.stuck_yielding_s : tick.gait.stuck_s;
    end_ = waited_ * dt > patience ? End::kStuck : found;
    if (end_ == End::kStuck && policy_ == AtLimit::kYields && limited_finger_ >= 0) {
      end_ = End::kJointLimit;
      end_finger_ = limited_finger_;
    }
  }
  return motion;
}

}  // namespace regrasp
