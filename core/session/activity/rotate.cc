#include "core/session/activity/rotate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/session/activity/explore.h"
#include "core/session/completed.h"

namespace regrasp {

void RotateActivity::Start(const Command& command, const ActivityContext& context) {
  *this = RotateActivity();
  FingerGait::Request request;
  request.angle_rad = command.angle_rad;
  request.continuous = command.continuous;
  request.axis_W = command.axis_W.normalized();
  request.speed_rad_s = command.speed_rad_s;
  request.seed = context.seed;
  gait_.Start(request, context.now, context.controller.wrench());
  q_WO_start_ = context.world.state().q_WO;
  p_WO_start_ = context.world.state().p_WO;
}

ActivityStep RotateActivity::Update(const ActivityContext& context) {
  const ObjectMotion motion = gait_.Update(context.now, &context.controller, &context.tasks);
  Assess(context);
  report_.Report(gait_, context);
  ActivityStep step;
  if (gait_.phase() == GaitPhase::kFailed) {
    step = ActivityStep::Failed(gait_.error());
  } else if (!gait_.active()) {
    step = gait_.stopped() ? ActivityStep::Ended(JobState::kCancelled) : Done(context);
  }
  step.motion = motion;
  return step;
}

ActivityStep RotateActivity::Done(const ActivityContext& context) const {
  const double turned = context.job.rotate.angle_rad, asked = gait_.target();
  if (TurnedAsAsked(turned, asked)) return ActivityStep::Ended(JobState::kDone);
  constexpr double kDegrees = 180 / std::numbers::pi;
  char error[sizeof(ActivityStep::error)];
  std::snprintf(error, sizeof error, "the object has turned by %.1f instead of %.1f degrees",
                kDegrees * turned, kDegrees * asked);
  return ActivityStep::Failed(error);
}

ActivityStep RotateActivity::Stop(const ActivityContext&) {
  gait_.Stop();
  return {};
}

void RotateActivity::Dropped(const ActivityContext& context) { context.job.rotate.dropped = true; }

void RotateActivity::Assess(const ActivityContext& context) const {
  RotateResult& r = context.job.rotate;
  const WorldState& truth = context.world.state();
  const Vector3d& axis = gait_.request().axis_W;
  const Quaterniond q = truth.q_WO * q_WO_start_.conjugate();
  const double twist = 2.0 * std::atan2(q.vec().dot(axis), q.w());
  r.angle_rad += std::remainder(twist - r.angle_rad, 2.0 * std::numbers::pi);
  r.turns = r.angle_rad / (2.0 * std::numbers::pi);
  r.max_tilt_rad = std::max(r.max_tilt_rad, std::acos(std::clamp(axis.dot(q * axis), -1.0, 1.0)));
  r.max_position_error_m = std::max(r.max_position_error_m, (truth.p_WO - p_WO_start_).norm());
  r.max_lag_m = std::max(r.max_lag_m, (truth.p_WO - context.controller.wrench().p_ref()).norm());
  r.reference_resets = gait_.forgiveness().times();
  r.gait_cycles = gait_.cycles();
  r.regrasps = gait_.regrasps();
  r.sim_time_s = context.job_time_s();
  if (!gait_.request().continuous)
    context.job.progress = std::clamp(gait_.turned() / gait_.target(), 0.0, 0.99);
}

void RotateActivity::Record(const ActivityContext& context, Frame* frame) const {
  GaitFrame& gait = frame->gait;
  gait.active = true;
  gait.phase = static_cast<int>(gait_.phase());
  gait.finger = gait_.finger();
  const GaitStateName state = GaitStateNameOf(context.now.hand, gait_.finger());
  std::copy(state.text.begin(), state.text.end(), gait.state);
  gait.reference_angle_rad = gait.target_angle_rad = gait_.turned();
  gait.achieved_angle_rad = context.job.rotate.angle_rad;
  gait.cycles = gait_.cycles();
  gait.regrasps = gait_.regrasps();
  const GuidedSlide& slide = gait_.regrasp().slide();
  if (slide.phase() != GuidedSlide::Phase::kExplore) return;
  const int finger = slide.request().finger;
  if (context.tasks[finger].mode == FingerMode::kSlide)
    frame->fingers[finger].role = FingerRole::kExplore;
  frame->exploration = FrameOf(slide, context.parameters.exploration.epsilon);
}

}  // namespace regrasp
