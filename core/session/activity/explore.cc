#include "core/session/activity/explore.h"

#include <algorithm>
#include <cmath>

#include "core/gait/may_not_leave.h"

namespace regrasp {
namespace {

constexpr int kPathTicks = 10;  // from one look at the path to the next
constexpr double kFall = 0.02;  // of phi: more than its noise

ExploreReason ReasonOf(FingerExploration::End end) {
  switch (end) {
    case FingerExploration::End::kGradient:
      return ExploreReason::kGradient;
    case FingerExploration::End::kNoGain:
      return ExploreReason::kNoGain;
    case FingerExploration::End::kMaxCycles:
      return ExploreReason::kMaxCycles;
    case FingerExploration::End::kObjectMoved:
      return ExploreReason::kObjectMoved;
    case FingerExploration::End::kContactLost:
      return ExploreReason::kContactLost;
    case FingerExploration::End::kTime:
    case FingerExploration::End::kNone:
      return ExploreReason::kNone;
  }
  return ExploreReason::kNone;
}

}  // namespace

Verdict ExploreActivity::MayStart(const Command& command, const ActivityContext& context) {
  constexpr auto kRefused = Verdict::Kind::kBadState;
  if (command.finger < 0 || command.finger >= context.now.hand.num_fingers())
    return {kRefused, "no such finger", "regrasp contacts"};
  if (context.now.estimate.fingers[command.finger].in_contact) return {};
  std::snprintf(refusal_, sizeof(refusal_), "%s does not touch the object",
                context.now.hand.fingers[command.finger].name.c_str());
  return {kRefused, refusal_, "regrasp quality"};
}

void ExploreActivity::Start(const Command& command, const ActivityContext& context) {
  *this = ExploreActivity();
  ExploreResult& result = context.job.explore;
  result.finger = command.finger;
  result.criterion = command.criterion;
  result.estimator = command.estimator;
  result.seed = command.seed;
  request_ = {command.finger, command.criterion,  command.estimator,
              command.seed,   command.max_cycles, TurnAxisOf(context.now.exploration)};
  if (context.now.margins.without[command.finger] >= context.now.gait.margin_min) {
    exploration_.Start(request_);
    return;
  }
  FingerGait::Request request;
  request.seed = context.seed;
  request.make_room_for = command.finger;
  room_.Start(request, context.now, context.controller.wrench());
}

ActivityStep ExploreActivity::MakeRoom(const ActivityContext& context) {
  room_.Update(context.now, &context.controller, &context.tasks);
  report_.Report(room_, context);
  if (room_.active()) return {};
  if (room_.stopped()) return ActivityStep::Ended(JobState::kCancelled);
  const int finger = request_.finger;
  const double margin = context.now.margins.without[finger];
  if (margin >= context.now.gait.margin_min) {
    exploration_.Start(request_);
    return {};
  }
  const double below = context.now.gait.margin_min;
  context.log.Emit(context.tick, EventKind::kRefused, finger, margin, "%s",
                   MayNotLeave(context.now.hand, finger, margin, below).data());
  return ActivityStep::Failed(MayNotLeave(context.now.hand, finger, margin, below, 2).data());
}

ActivityStep ExploreActivity::Update(const ActivityContext& context) {
  if (room_.active()) return MakeRoom(context);
  const bool was_on_stability = exploration_.on_stability();
  exploration_.Update(context.now, &context.controller, &context.tasks);
  if (exploration_.on_stability() != was_on_stability)
    context.log.Emit(context.tick, EventKind::kCriterion, request_.finger,
                     exploration_.on_stability(), "objective: %s",
                     exploration_.on_stability() ? "stability" : "manipulability");
  Assess(context);
  if (exploration_.phase() != FingerExploration::Phase::kDone) return {};
  switch (context.job.explore.reason) {
    case ExploreReason::kCancelled:
      return ActivityStep::Ended(JobState::kCancelled);
    case ExploreReason::kContactLost:
      return ActivityStep::Failed("the exploring finger lost contact");
    default:
      return ActivityStep::Ended(JobState::kDone);
  }
}

ActivityStep ExploreActivity::Stop(const ActivityContext& context) {
  context.job.explore.reason = ExploreReason::kCancelled;
  room_.active() ? room_.Stop() : exploration_.Stop();
  return {};
}

void ExploreActivity::Dropped(const ActivityContext& context) {
  context.job.explore.reason = ExploreReason::kDropped;
  if (!room_.active()) AssessEnd(context);
}

double ExploreActivity::TruePhi(const ActivityContext& context) const {
  context.judge.Look(context.tick, context.world.state(), context.parameters.control);
  return context.judge.Phi(
      {request_.criterion, request_.finger, context.now.grasp, request_.turn_axis_W},
      context.parameters, exploration_.on_stability());
}

void ExploreActivity::Assess(const ActivityContext& context) {
  ExploreResult& result = context.job.explore;
  if (exploration_.slide_began()) {
    result.phi_initial = exploration_.phi_initial();
    result.phi_true_initial = TruePhi(context);
    p_path_ = context.judge.estimate().fingers[request_.finger].p_WC;
  }
  if (exploration_.phase() == FingerExploration::Phase::kExplore &&
      context.tick % kPathTicks == 0) {
    const Vector3d& p_WC = context.judge.estimate().fingers[request_.finger].p_WC;
    result.path_length_m += (p_WC - p_path_).norm();
    p_path_ = p_WC;
    context.job.progress =
        std::min(0.99, static_cast<double>(exploration_.cycles()) /
                           MaxCycles(request_.max_cycles, context.now.exploration));
  }
  if (!exploration_.slide_ended()) return;
  AssessEnd(context);
  result.phi_final = exploration_.phi_final();
  if (exploration_.end() != FingerExploration::End::kNone)
    result.reason = ReasonOf(exploration_.end());
  if (result.reason == ExploreReason::kGradient &&
      result.phi_initial - result.phi_final > kFall * std::abs(result.phi_initial))
    result.reason = ExploreReason::kFell;
  result.converged = result.reason == ExploreReason::kGradient;
}

void ExploreActivity::AssessEnd(const ActivityContext& context) {
  ExploreResult& result = context.job.explore;
  result.cycles = exploration_.cycles();
  result.phi_final = exploration_.phi();
  result.phi_true_final = TruePhi(context);
}

void ExploreActivity::Record(const ActivityContext& context, Frame* frame) const {
  for (std::size_t i = 0; i < frame->fingers.size(); ++i)
    if (context.tasks[i].mode == FingerMode::kSlide) frame->fingers[i].role = FingerRole::kExplore;
  if (exploration_.slide().active())
    frame->exploration = FrameOf(exploration_.slide(), context.now.exploration.epsilon);
}

ExplorationFrame FrameOf(const GuidedSlide& slide, double epsilon) {
  ExplorationFrame frame;
  frame.active = true;
  frame.finger = slide.request().finger;
  frame.criterion = slide.request().criterion;
  frame.on_stability = slide.on_stability();
  frame.cycle = slide.cycles();
  if (slide.phi_known()) frame.phi = slide.phi();
  frame.epsilon = epsilon;
  if (slide.cycles() > 0) frame.gradient_norm = slide.algorithm().gradient_norm();
  frame.gradient_W = slide.algorithm().gradient_W();
  frame.velocity_W = slide.algorithm().velocity_W();
  return frame;
}

}  // namespace regrasp
