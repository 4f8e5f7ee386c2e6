#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/session/session_impl.h"

namespace regrasp {
namespace {

constexpr double kDropContactTime_s = 0.25;  // fewer than two contacts for so long: dropped

/// Filters off: turns noise-free readings into the truth in the controller's own terms.
ControlParameters Unfiltered(ControlParameters parameters) {
  parameters.joint_filter_s = parameters.force_filter_s = 0;
  parameters.contact_filter_s = parameters.pose_filter_s = 0;
  parameters.contact_from_normal = 0;
  return parameters;
}

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

void Session::Impl::LookAtTruth() {
  judge.Update(judge_sensors->Read(tick, world->state()), Unfiltered(parameters.control));
}

void Session::Impl::WatchContacts() {
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const FingerEstimate& f = estimator.estimate().fingers[i];
    const bool now = was_in_contact[i] ? f.ticks_without_contact < 20 : f.in_contact;
    if (now == was_in_contact[i]) continue;
    was_in_contact[i] = now;
    Emit(now ? EventKind::kContactMade : EventKind::kContactLost, i, 0, "%s: contact %s",
         hand.fingers[i].name.c_str(), now ? "made" : "lost");
  }
}

void Session::Impl::WatchDrop() {
  const bool alone =
      state == SessionState::kHolding || state == SessionState::kExploring ||
      state == SessionState::kRotating || state == SessionState::kMoving ||
      (state == SessionState::kGrasping && grasp.phase() == GraspSequence::Phase::kAlone);
  if (!alone || release_tick >= 0) {
    drop_ticks = 0;
    return;
  }
  const Estimate& e = estimator.estimate();
  int touching = 0;
  for (const FingerEstimate& f : e.fingers) touching += f.in_contact;
  drop_ticks = touching < 2 ? drop_ticks + 1 : 0;
  const double distance = (e.p_WO - controller.wrench().p_ref()).norm();
  if (drop_ticks * dt < kDropContactTime_s && distance < parameters.control.drop_distance) return;
  if (state == SessionState::kExploring) {
    job.explore.reason = ExploreReason::kDropped;
    if (!gait.active()) JudgeExplorationEnd();
  }
  if (state == SessionState::kRotating) job.rotate.dropped = true;
  if (state == SessionState::kMoving) {
    job.move.reached = false;
    job.move.end = MoveEnd::kDropped;
    job.move.end_finger = -1;
  }
  exploration = FingerExploration();
  gait = FingerGait();
  move = ObjectMove();
  Emit(EventKind::kDropped, -1, distance,
       "dropped: object %.0f mm from its place, %d fingers touch", distance * 1e3, touching);
  FinishJob(JobState::kFailed, "the object was dropped");
  ToPosture(e.q);  // the hand stops where it is
  Enter(SessionState::kDropped);
}

double Session::Impl::TruePhi() {
  LookAtTruth();
  const auto& r = exploration.request();
  return Objective(r.criterion, r.finger, GraspFingers(), judge.estimate(), parameters.control,
                   parameters.exploration.stability_weight, exploration.on_stability())
      .phi;
}

void Session::Impl::JudgeExplorationEnd() {
  job.explore.cycles = exploration.cycles();
  job.explore.phi_final = exploration.phi();
  job.explore.phi_true_final = TruePhi();
}

void Session::Impl::JudgeRotation() {
  RotateResult& r = job.rotate;
  const WorldState& truth = world->state();
  const Vector3d& axis = gait.request().axis_W;
  const Quaterniond q = truth.q_WO * q_WO_start.conjugate();
  const double twist = 2.0 * std::atan2(q.vec().dot(axis), q.w());
  r.angle_rad += std::remainder(twist - r.angle_rad, 2.0 * std::numbers::pi);
  r.turns = r.angle_rad / (2.0 * std::numbers::pi);
  r.max_tilt_rad = std::max(r.max_tilt_rad, std::acos(std::clamp(axis.dot(q * axis), -1.0, 1.0)));
  r.max_position_error_m =
      std::max(r.max_position_error_m, (truth.p_WO - controller.wrench().p_ref()).norm());
  r.gait_cycles = gait.cycles();
  r.regrasps = gait.regrasps();
  r.sim_time_s = static_cast<double>(tick - job.start_tick) * dt;
  if (!gait.request().continuous)
    job.progress = std::clamp(gait.turned() / gait.target(), 0.0, 0.99);
}

void Session::Impl::JudgeMove() {
  MoveResult& r = job.move;
  const WorldState& truth = world->state();
  const ObjectWrench& wrench = controller.wrench();
  r.achieved_offset_m = truth.p_WO - p_WO_start;
  r.achieved_rotation_rad = RotationVector(truth.q_WO * q_WO_start.conjugate());
  r.max_position_error_m = std::max(r.max_position_error_m, (truth.p_WO - wrench.p_ref()).norm());
  r.max_rotation_error_rad = std::max(
      r.max_rotation_error_rad, RotationVector(wrench.q_ref() * truth.q_WO.conjugate()).norm());
  r.end = MoveEndOf(move.manipulation().end());
  r.reached = r.end == MoveEnd::kReached;
  const bool of_finger = r.end == MoveEnd::kJointLimit || r.end == MoveEnd::kManipulability ||
                         r.end == MoveEnd::kExcursion;
  r.end_finger = of_finger ? move.manipulation().end_finger() : -1;
  r.sim_time_s = static_cast<double>(tick - job.start_tick) * dt;
  job.progress = std::clamp(move.progress(), 0.0, 0.99);
}

double Session::Impl::TruePhiOf(int finger) {
  LookAtTruth();
  const Regrasp& r = gait.regrasp();
  if (r.request().criterion != Criterion::kStability && !r.on_stability())
    return judge.estimate().fingers[finger].manipulability;
  return GraspStability(judge.estimate(), GraspFingers().without(r.request().without),
                        parameters.control);
}

void Session::Impl::ReportGait() {
  const FingerGait::Happened& happened = gait.happened();
  if (happened.refused_finger >= 0)
    Emit(EventKind::kRefused, happened.refused_finger, happened.refused_margin,
         "%s may not leave: load margin %.3f N without it",
         hand.fingers[happened.refused_finger].name.c_str(), happened.refused_margin);
  if (happened.aborted)
    Emit(EventKind::kSlip, gait.regrasp().request().finger, happened.error_position,
         "regrasp broken off: object %.1f mm, %.0f deg off", happened.error_position * 1e3,
         happened.error_rotation * 180.0 / std::numbers::pi);
  const int finger = gait.regrasp().request().finger;
  if (happened.explore_began) regrasp.phi_start = TruePhiOf(finger);
  if (happened.regrasp_ended) {
    regrasp.finger = finger;
    regrasp.criterion = gait.regrasp().request().criterion;
    regrasp.on_stability = gait.regrasp().on_stability();
    regrasp.aborted = gait.regrasp().aborted();
    regrasp.phi_after = TruePhiOf(finger);
    if (!gait.regrasp().request().explore) regrasp.phi_start = regrasp.phi_before;
    Emit(EventKind::kRegrasp, finger, regrasp.phi_after, "%s regrasped: %s %.4f -> %.4f",
         hand.fingers[finger].name.c_str(),
         regrasp.on_stability || regrasp.criterion == Criterion::kStability ? "stability"
                                                                            : "manipulability",
         regrasp.phi_before, regrasp.phi_after);
    const bool on_manipulability =
        regrasp.criterion != Criterion::kStability && !regrasp.on_stability;
    if (gait.regrasp().request().explore && on_manipulability && !regrasp.aborted)
      events.back().from = regrasp.phi_start;
  }
  if (happened.regrasp_began) {
    regrasp = RegraspRecord();
    regrasp.phi_before = TruePhiOf(finger);
  }
  if (!happened.changed || gait.phase() == GaitPhase::kChoose) return;
  if (gait.phase() == GaitPhase::kRegrasp)
    Emit(EventKind::kGaitPhase, finger, static_cast<double>(gait.phase()), "%s: %s",
         hand.fingers[finger].name.c_str(), Name(gait.regrasp().phase()).data());
  else
    Emit(EventKind::kGaitPhase, -1, static_cast<double>(gait.phase()), "%s",
         Name(gait.phase()).data());
}

}  // namespace regrasp
