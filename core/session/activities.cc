#include <algorithm>

#include "core/session/session_impl.h"

namespace regrasp {
namespace {

constexpr double kReleaseTime_s = 0.5;
constexpr double kReleasePull_n = 12.0;  // lets go at once, so that no finger drags on the object
constexpr double kReleasePullTime_s = 0.01;

}  // namespace

FingerSet Session::Impl::GraspFingers() const {
  FingerSet fingers;
  for (int i = 0; i < hand.num_fingers(); ++i)
    if (tasks[i].mode != FingerMode::kPosture) fingers.add(i);
  return fingers;
}

ControlTick Session::Impl::MakeTick() const {
  return {hand,
          estimator.estimate(),
          GraspFingers(),
          monitor.margins(),
          parameters.gravity_W,
          parameters.control,
          parameters.exploration,
          parameters.gait,
          dt};
}

void Session::Impl::UpdateGrasp() {
  grasp.Update(MakeTick(), q_closed, &controller, &tasks);
  job.progress = std::min(0.99, grasp.progress());
  if (world->stand_in() != grasp.needs_stand_in()) {
    world->SetStandIn(grasp.needs_stand_in());
    Emit(EventKind::kStandIn, -1, world->stand_in(), "stand-in %s",
         world->stand_in() ? "holds the object" : "let go");
  }
  if (grasp.phase() == GraspSequence::Phase::kDone) {
    FinishJob(JobState::kDone, "");
    Enter(SessionState::kHolding);
  } else if (grasp.phase() == GraspSequence::Phase::kFailed) {
    FinishJob(JobState::kFailed, "fewer than three fingers touched the object");
    ToPosture(q_open);
    Enter(SessionState::kIdle);
  }
}

void Session::Impl::UpdateRelease() {
  const double time = (tick - release_tick) * dt;
  if (time == 0) ToPosture(q_open);
  job.progress = std::min(0.99, time / kReleaseTime_s);
  if (time < kReleaseTime_s) return;
  release_tick = -1;
  FinishJob(JobState::kDone, "");
  Enter(SessionState::kIdle);
}

void Session::Impl::AddReleasePull() {
  if (release_tick < 0 || (tick - release_tick) * dt >= kReleasePullTime_s) return;
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const FingerEstimate& f = estimator.estimate().fingers[i];
    if (!f.ever_in_contact) continue;
    const FingerVector tau = f.J.transpose() * (kReleasePull_n * f.normal_W);
    const auto& joints = hand.fingers[i].joints;
    for (std::size_t k = 0; k < joints.size(); ++k) torque[joints[k]] += tau[k];
  }
}

void Session::Impl::StartExploration(const Command& command) {
  job.explore.finger = command.finger;
  job.explore.criterion = command.criterion;
  job.explore.estimator = command.estimator;
  job.explore.seed = command.seed;
  explore_request = {command.finger, command.criterion, command.estimator, command.seed,
                     command.max_cycles};
  Enter(SessionState::kExploring);
  if (monitor.margins().without[command.finger] >= parameters.gait.margin_min) {
    exploration.Start(explore_request);
    return;
  }
  FingerGait::Request request;
  request.seed = seed;
  request.make_room_for = command.finger;
  gait.Start(request, MakeTick(), controller.wrench());
}

void Session::Impl::MakeRoom() {
  gait.Update(MakeTick(), &controller, &tasks);
  ReportGait();
  if (gait.active()) return;
  const int finger = explore_request.finger;
  const double margin = monitor.margins().without[finger];
  if (gait.stopped()) {
    FinishJob(JobState::kCancelled, "");
  } else if (margin < parameters.gait.margin_min) {
    char error[128];
    std::snprintf(error, sizeof(error),
                  "%s may not leave: the load margin without it is %.2f N, below %.2f N",
                  hand.fingers[finger].name.c_str(), margin, parameters.gait.margin_min);
    Emit(EventKind::kRefused, finger, margin, "%s may not leave: load margin %.3f N without it",
         hand.fingers[finger].name.c_str(), margin);
    FinishJob(JobState::kFailed, error);
  } else {
    exploration.Start(explore_request);
    return;
  }
  Enter(SessionState::kHolding);
}

void Session::Impl::UpdateExploration() {
  if (gait.active()) {
    MakeRoom();
    return;
  }
  const bool was_on_stability = exploration.on_stability();
  exploration.Update(MakeTick(), &controller, &tasks);
  const int finger = exploration.request().finger;
  if (exploration.on_stability() != was_on_stability)
    Emit(EventKind::kCriterion, finger, exploration.on_stability(), "objective: %s",
         exploration.on_stability() ? "stability" : "manipulability");
  const FingerEstimate& truth = judge.estimate().fingers[finger];
  if (exploration.slide_began()) {
    job.explore.phi_initial = exploration.phi_initial();
    job.explore.phi_true_initial = TruePhi();
    p_path = truth.p_WC;
  }
  if (exploration.phase() == FingerExploration::Phase::kSlide && tick % kJudgeInterval == 0) {
    job.explore.path_length_m += (truth.p_WC - p_path).norm();
    p_path = truth.p_WC;
    const double limit =
        job.explore.cycles > 0 ? job.explore.cycles : parameters.exploration.max_cycles;
    job.progress = std::min(0.99, exploration.cycles() / limit);
  }
  if (exploration.slide_ended()) {
    JudgeExplorationEnd();
    job.explore.phi_final = exploration.phi_final();
    switch (exploration.end()) {
      case FingerExploration::End::kGradient:
        job.explore.reason = ExploreReason::kGradient;
        break;
      case FingerExploration::End::kMaxCycles:
        job.explore.reason = ExploreReason::kMaxCycles;
        break;
      case FingerExploration::End::kObjectMoved:
        job.explore.reason = ExploreReason::kObjectMoved;
        break;
      case FingerExploration::End::kContactLost:
        job.explore.reason = ExploreReason::kContactLost;
        break;
      case FingerExploration::End::kNone:
        break;  // stopped: cancelled
    }
    job.explore.converged = job.explore.reason == ExploreReason::kGradient;
  }
  if (exploration.phase() != FingerExploration::Phase::kDone) return;
  exploration = FingerExploration();
  const ExploreReason reason = job.explore.reason;
  if (reason == ExploreReason::kCancelled) {
    FinishJob(JobState::kCancelled, "");
  } else if (reason == ExploreReason::kContactLost) {
    FinishJob(JobState::kFailed, "the exploring finger lost contact");
  } else {
    FinishJob(JobState::kDone, "");
  }
  Enter(SessionState::kHolding);
}

void Session::Impl::StartRotation(const Command& command) {
  FingerGait::Request request;
  request.angle_rad = command.angle_rad;
  request.continuous = command.continuous;
  request.axis_W = command.axis_W.normalized();
  request.speed_rad_s = command.speed_rad_s;
  request.seed = seed;
  gait.Start(request, MakeTick(), controller.wrench());
  q_WO_start = world->state().q_WO;
  motion = ObjectMotion();
  Enter(SessionState::kRotating);
}

void Session::Impl::UpdateRotation() {
  motion = gait.Update(MakeTick(), &controller, &tasks);
  JudgeRotation();
  ReportGait();
  if (gait.active()) return;
  if (gait.phase() == GaitPhase::kFailed) {
    FinishJob(JobState::kFailed, gait.error());
  } else {
    FinishJob(gait.stopped() ? JobState::kCancelled : JobState::kDone, "");
  }
  Enter(SessionState::kHolding);
}

void Session::Impl::StartMove(const Command& command) {
  job.move.offset_m = command.offset_W;
  job.move.rotation_rad = command.rotation_W;
  move.Start({command.offset_W, command.rotation_W}, MakeTick(), controller.wrench());
  p_WO_start = world->state().p_WO;
  q_WO_start = world->state().q_WO;
  Enter(SessionState::kMoving);
}

void Session::Impl::UpdateMove() {
  motion = move.Update(MakeTick(), &controller, &tasks);
  JudgeMove();
  if (move.active()) return;
  const bool stopped = move.stopped() && !job.move.reached;
  if (stopped) job.move.end = MoveEnd::kStopped;
  FinishJob(stopped ? JobState::kCancelled : JobState::kDone, "");
  move = ObjectMove();
  Enter(SessionState::kHolding);
}

}  // namespace regrasp
