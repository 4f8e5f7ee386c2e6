#include "core/gait/object_move.h"

#include <algorithm>

namespace regrasp {
namespace {

constexpr double kMarginFilter_s = 0.05;
constexpr double kYieldingCap = 2.0;  // of the preferred force of a finger that shall slip
constexpr double kRest_s = 0.4;       // until the object has caught up with its reference

}  // namespace

void ObjectMove::Start(const Request& request, const HandModel& hand, const Estimate& estimate,
                       const ObjectWrench& wrench, unsigned fingers,
                       const GaitParameters& parameters) {
  *this = ObjectMove();
  active_ = true;
  fingers_ = fingers;
  home_.p_WO = wrench.p_ref();
  for (int i = 0; i < hand.num_fingers(); ++i) {
    home_.p_OC[i] = estimate.fingers[i].p_WC - wrench.p_ref();
    home_.manipulability[i] = estimate.fingers[i].manipulability;
  }
  const double angle = request.rotation_W.norm(), distance = request.offset_W.norm();
  const double length = angle > 0 ? angle : distance;
  const double duration =
      std::max(angle / parameters.speed_rad_s, distance / parameters.move_speed);
  const double speed = length / duration;
  // The ramp takes as long as that of a turn at full speed.
  const double acceleration = speed * parameters.acceleration / parameters.speed_rad_s;
  manipulation_.Start({request.offset_W / length, request.rotation_W / length}, length, speed,
                      acceleration, LocalManipulation::AtLimit::kYields);
}

ObjectMotion ObjectMove::Update(const HandModel& hand, const Estimate& estimate, double margin,
                                const std::array<double, kMaxFingers>& margin_without,
                                const ControlParameters& control, const GaitParameters& parameters,
                                double dt, HybridController* controller, FingerTasks* tasks) {
  const double gain = have_margins_ ? dt / (kMarginFilter_s + dt) : 1.0;
  have_margins_ = true;
  margin_ += gain * (margin - margin_);
  for (std::size_t i = 0; i < margin_without.size(); ++i)
    margin_without_[i] += gain * (margin_without[i] - margin_without_[i]);

  // Of the fingers at a limit the one that the grasp can best do without.
  int yielding = -1;
  for (int i = 0; i < hand.num_fingers(); ++i)
    if ((fingers_ & manipulation_.at_limit()) >> i & 1u &&
        margin_without_[i] >= parameters.margin_min &&
        (yielding < 0 || margin_without_[i] > margin_without_[yielding]))
      yielding = i;
  for (int i = 0; i < hand.num_fingers(); ++i) {
    if (!(fingers_ >> i & 1u)) continue;
    FingerTask& task = (*tasks)[i];
    task.mode = FingerMode::kHold;
    task.cap = control.max_normal_force;
    task.grip = parameters.grip_force;
    if (i != yielding) continue;
    task.cap = std::min(task.cap, kYieldingCap * parameters.slide_force);
    task.grip = parameters.slide_force;
  }

  using End = LocalManipulation::End;
  if (manipulation_.end() != End::kNone) {
    active_ = ++rest_ticks_ * dt < kRest_s;
    return {};
  }
  const ObjectMotion motion = manipulation_.Update(hand, estimate, controller->wrench(), home_,
                                                   fingers_, margin_, parameters, dt);
  const End end = manipulation_.end();
  if (end == End::kNone || end == End::kReached) return motion;
  controller->wrench().SetReference(estimate.p_WO, estimate.q_WO);
  return {};
}

void ObjectMove::AddTo(StateHasher* hasher) const {
  hasher->Add(active_);
  if (!active_) return;
  hasher->Add(stop_);
  hasher->Add(fingers_);
  hasher->Add(home_.p_WO);
  for (const Vector3d& p_OC : home_.p_OC) hasher->Add(p_OC);
  for (double manipulability : home_.manipulability) hasher->Add(manipulability);
  hasher->Add(margin_);
  for (double margin : margin_without_) hasher->Add(margin);
  hasher->Add(rest_ticks_);
  manipulation_.AddTo(hasher);
}

}  // namespace regrasp
