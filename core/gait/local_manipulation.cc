#include "core/gait/local_manipulation.h"

#include <algorithm>

namespace regrasp {
namespace {

constexpr double kStuck_s = 0.5;
constexpr double kStuckYielding_s = 1.0;  // a finger that begins to slip takes its time
constexpr double kMovesTurning = 0.3;     // rad per rad of the object
constexpr double kMovesShifting = 12.0;  // rad per m of the object: the same at 25 mm from its axis
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
  *this = LocalManipulation();
  per_path_ = per_path;
  length_ = length;
  speed_max_ = speed;
  acceleration_ = acceleration;
  policy_ = policy;
}

LocalManipulation::End LocalManipulation::FindEnd(const HandModel& hand, const Estimate& estimate,
                                                  const Home& home, unsigned fingers, double margin,
                                                  const GaitParameters& parameters) {
  limited_finger_ = -1;
  // A joint that moves less than this, per unit of path, may stand at its limit.
  const double least_rate = (turns() ? kMovesTurning : 0.0) + kMovesShifting * per_path_.v_W.norm();
  for (int i = 0; i < hand.num_fingers(); ++i) {
    if (!(fingers >> i & 1u)) continue;
    const FingerEstimate& f = estimate.fingers[i];
    end_finger_ = i;
    const Vector3d v = per_path_.w_W.cross(f.p_WC - estimate.p_WO) + per_path_.v_W;
    const Matrix3d inverse = (f.J * f.J.transpose() + 1e-6 * Matrix3d::Identity()).inverse();
    const Vector3d along = inverse * v;
    const auto& joints = hand.fingers[i].joints;
    bool limited = false;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const double q = estimate.q[joints[k]];
      const double rate = f.J.col(static_cast<Eigen::Index>(k)).dot(along);
      const Joint& joint = hand.joints[joints[k]];
      if ((q > joint.upper - parameters.limit_margin && rate > least_rate) ||
          (q < joint.lower + parameters.limit_margin && rate < -least_rate))
        limited = true;
    }
    if (limited) {
      limited_finger_ = i;
      at_limit_ |= 1u << i;
      if (travelled_ == 0) at_limit_at_first_ |= 1u << i;
      if (policy_ == AtLimit::kEnds && !(at_limit_at_first_ >> i & 1u)) return End::kJointLimit;
    }
    if (f.manipulability < parameters.min_manipulability * home.manipulability[i])
      return End::kManipulability;
    const Vector3d excursion = f.p_WC - home.p_WO - home.p_OC[i];
    if (excursion.norm() > parameters.max_excursion && excursion.dot(v) > 0) return End::kExcursion;
  }
  end_finger_ = -1;
  return margin < parameters.margin_min ? End::kMargin : End::kNone;
}

ObjectMotion LocalManipulation::Update(const HandModel& hand, const Estimate& estimate,
                                       const ObjectWrench& wrench, const Home& home,
                                       unsigned fingers, double margin,
                                       const GaitParameters& parameters, double dt) {
  ObjectMotion motion;
  if (end_ != End::kNone) return motion;
  const End found = FindEnd(hand, estimate, home, fingers, margin, parameters);
  const double left = length_ - travelled_;
  const double e_p = (wrench.p_ref() - estimate.p_WO).norm();
  const double e_r = RotationVector(wrench.q_ref() * estimate.q_WO.conjugate()).norm();
  const bool wait = e_p > parameters.lag_position || e_r > parameters.lag_rotation;
  waited_ = wait ? waited_ + 1 : 0;
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
    const double patience = policy_ == AtLimit::kYields ? kStuckYielding_s : kStuck_s;
    end_ = waited_ * dt > patience ? End::kStuck : found;
    if (end_ == End::kStuck && policy_ == AtLimit::kYields && limited_finger_ >= 0) {
      end_ = End::kJointLimit;
      end_finger_ = limited_finger_;
    }
  }
  return motion;
}

void LocalManipulation::AddTo(StateHasher* hasher) const {
  hasher->Add(per_path_.v_W);
  hasher->Add(per_path_.w_W);
  hasher->Add(length_);
  hasher->Add(speed_max_);
  hasher->Add(acceleration_);
  hasher->Add(travelled_);
  hasher->Add(speed_);
  hasher->Add(policy_);
  hasher->Add(at_limit_);
  hasher->Add(stop_);
  hasher->Add(at_limit_at_first_);
  hasher->Add(waited_);
  hasher->Add(end_);
}

}  // namespace regrasp
