#include "core/gait/object_move.h"

#include <algorithm>

namespace regrasp {

void ObjectMove::Start(const Request& request, const ControlTick& tick,
                       const ObjectWrench& wrench) {
  *this = ObjectMove();
  active_ = true;
  home_ = MakeHome(tick.estimate, wrench);
  const GaitParameters& parameters = tick.gait;
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

int ObjectMove::YieldingFinger(const ControlTick& tick) const {
  const auto& margins = tick.margins.without;
  const auto may = [&](int i) {
    return tick.grasp.contains(i) && margins[i] >= tick.gait.margin_min;
  };
  const FingerSet at_limit = manipulation_.at_limit();
  if (at_limit.contains(yielding_) && may(yielding_) && slides(tick)) return yielding_;
  int yielding = -1;
  for (int i : at_limit)
    if (may(i) && (yielding < 0 || margins[i] > margins[yielding])) yielding = i;
  return yielding;
}

void ObjectMove::Yield(const ControlTick& tick, FingerTask* task) {
  const GaitParameters& parameters = tick.gait;
  ++yield_ticks_;
  if (slides(tick) && manipulation_.end() == LocalManipulation::End::kNone) {
    const Vector3d along =
        TangentPart(manipulation_.ContactRate(tick, yielding_), tick.finger(yielding_).normal_W);
    task->mode = FingerMode::kSlide;
    task->force = parameters.slide_force;
    task->v_W = -parameters.slide_speed * along.normalized();
    return;
  }
  task->cap = std::min(task->cap, parameters.yielding_cap * parameters.slide_force);
  task->grip = parameters.slide_force;
}

ObjectMotion ObjectMove::Update(const ControlTick& tick, HybridController* controller,
                                FingerTasks* tasks) {
  if (yielding_ >= 0 && manipulation_.HasRoom(tick, yielding_)) manipulation_.Freed(yielding_);
  const int yielding = YieldingFinger(tick);
  if (yielding != yielding_) yield_ticks_ = 0;
  yielding_ = yielding;
  for (int i : tick.grasp) {
    FingerTask& task = (*tasks)[i];
    task.mode = FingerMode::kHold;
    task.cap = tick.control.max_normal_force;
    task.grip = tick.gait.grip_force;
    if (i == yielding_) Yield(tick, &task);
  }

  using End = LocalManipulation::End;
  if (manipulation_.end() != End::kNone) {
    active_ = ++rest_ticks_ * tick.dt < tick.gait.rest_s;
    return {};
  }
  const ObjectMotion motion = manipulation_.Update(tick, controller->wrench(), home_);
  const End end = manipulation_.end();
  if (end == End::kNone || end == End::kReached) return motion;
  controller->wrench().SetReference(tick.estimate.p_WO, tick.estimate.q_WO);
  return {};
}

}  // namespace regrasp
