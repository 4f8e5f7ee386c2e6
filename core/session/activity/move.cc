#include "core/session/activity/move.h"

#include <algorithm>

namespace regrasp {
namespace {

MoveEnd MoveEndOf(LocalManipulation::End end) {
  using End = LocalManipulation::End;
  switch (end) {
    case End::kNone:
      return MoveEnd::kNone;
    case End::kReached:
      return MoveEnd::kReached;
    case End::kJointLimit:
      return MoveEnd::kJointLimit;
    case End::kStuck:
      return MoveEnd::kObjectStuck;
    case End::kManipulability:
      return MoveEnd::kManipulability;
    case End::kExcursion:
      return MoveEnd::kExcursion;
    case End::kMargin:
      return MoveEnd::kLoadMargin;
    case End::kStopped:
      return MoveEnd::kStopped;
  }
  return MoveEnd::kNone;
}

}  // namespace

void MoveActivity::Start(const Command& command, const ActivityContext& context) {
  *this = MoveActivity();
  context.job.move.offset_m = command.offset_W;
  context.job.move.rotation_rad = command.rotation_W;
  move_.Start({command.offset_W, command.rotation_W}, context.now, context.controller.wrench());
  p_WO_start_ = context.world.state().p_WO;
  q_WO_start_ = context.world.state().q_WO;
}

ActivityStep MoveActivity::Update(const ActivityContext& context) {
  const ObjectMotion motion = move_.Update(context.now, &context.controller, &context.tasks);
  Assess(context);
  ActivityStep step;
  if (!move_.active()) {
    MoveResult& result = context.job.move;
    const bool stopped = move_.stopped() && !result.reached;
    if (stopped) result.end = MoveEnd::kStopped;
    step = ActivityStep::Ended(stopped ? JobState::kCancelled : JobState::kDone);
  }
  step.motion = motion;
  return step;
}

ActivityStep MoveActivity::Stop(const ActivityContext&) {
  move_.Stop();
  return {};
}

void MoveActivity::Dropped(const ActivityContext& context) {
  MoveResult& result = context.job.move;
  result.reached = false;
  result.end = MoveEnd::kDropped;
  result.end_finger = -1;
}

void MoveActivity::Assess(const ActivityContext& context) const {
  MoveResult& r = context.job.move;
  const WorldState& truth = context.world.state();
  const ObjectWrench& wrench = context.controller.wrench();
  r.achieved_offset_m = truth.p_WO - p_WO_start_;
  r.achieved_rotation_rad = RotationVector(truth.q_WO * q_WO_start_.conjugate());
  r.max_position_error_m = std::max(r.max_position_error_m, (truth.p_WO - wrench.p_ref()).norm());
  r.max_rotation_error_rad = std::max(
      r.max_rotation_error_rad, RotationVector(wrench.q_ref() * truth.q_WO.conjugate()).norm());
  r.end = MoveEndOf(move_.manipulation().end());
  r.reached = r.end == MoveEnd::kReached;
  const bool of_finger = r.end == MoveEnd::kJointLimit || r.end == MoveEnd::kManipulability ||
                         r.end == MoveEnd::kExcursion;
  r.end_finger = of_finger ? move_.manipulation().end_finger() : -1;
  r.sim_time_s = context.job_time_s();
  context.job.progress = std::clamp(move_.progress(), 0.0, 0.99);
}

}  // namespace regrasp
