#include "core/session/frame.h"
#include "core/session/job.h"

namespace regrasp {

std::string_view Name(JobMethod method) {
  if (method == JobMethod::kStep) return "step";
  if (method == JobMethod::kRestore) return "checkpoint.restore";
  const JobInfo* row = FindJob(&JobInfo::id, method);
  return row ? row->name : "";
}

std::string_view Name(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return "queued";
    case JobState::kRunning:
      return "running";
    case JobState::kDone:
      return "done";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
  }
  return "";
}

std::string_view Name(ExploreReason reason) {
  switch (reason) {
    case ExploreReason::kNone:
      return "";
    case ExploreReason::kGradient:
      return "gradient";
    case ExploreReason::kMaxCycles:
      return "max_cycles";
    case ExploreReason::kNoGain:
      return "no_gain";
    case ExploreReason::kFell:
      return "fell";
    case ExploreReason::kObjectMoved:
      return "object_moved";
    case ExploreReason::kContactLost:
      return "contact_lost";
    case ExploreReason::kDropped:
      return "dropped";
    case ExploreReason::kCancelled:
      return "cancelled";
  }
  return "";
}

std::string_view Name(MoveEnd end) {
  switch (end) {
    case MoveEnd::kNone:
      return "";
    case MoveEnd::kReached:
      return "reached";
    case MoveEnd::kJointLimit:
      return "joint_limit";
    case MoveEnd::kObjectStuck:
      return "object_stuck";
    case MoveEnd::kManipulability:
      return "manipulability";
    case MoveEnd::kExcursion:
      return "excursion";
    case MoveEnd::kLoadMargin:
      return "load_margin";
    case MoveEnd::kStopped:
      return "stopped";
    case MoveEnd::kDropped:
      return "dropped";
  }
  return "";
}

std::string_view Name(SessionState state) {
  if (const JobInfo* row = FindJob(&JobInfo::state, state)) return row->state_name;
  switch (state) {
    case SessionState::kIdle:
      return "idle";
    case SessionState::kHolding:
      return "holding";
    case SessionState::kDropped:
      return "dropped";
    case SessionState::kFaulted:
      return "faulted";
    default:
      return "";
  }
}

bool HoldsAlone(SessionState state, bool stand_in) {
  const JobInfo* row = FindJob(&JobInfo::state, state);
  return !stand_in && (row ? row->holds : state == SessionState::kHolding);
}

std::string_view Name(FingerRole role) {
  switch (role) {
    case FingerRole::kFree:
      return "free";
    case FingerRole::kHold:
      return "hold";
    case FingerRole::kExplore:
      return "explore";
    case FingerRole::kMove:
      return "move";
  }
  return "";
}

std::string_view Name(EventKind kind) {
  switch (kind) {
    case EventKind::kState:
      return "state";
    case EventKind::kJobStarted:
      return "job_started";
    case EventKind::kJobFinished:
      return "job_finished";
    case EventKind::kContactLost:
      return "contact_lost";
    case EventKind::kContactMade:
      return "contact_made";
    case EventKind::kCriterion:
      return "criterion";
    case EventKind::kDropped:
      return "dropped";
    case EventKind::kFault:
      return "fault";
    case EventKind::kGaitPhase:
      return "gait_phase";
    case EventKind::kRefused:
      return "refused";
    case EventKind::kSlip:
      return "slip";
    case EventKind::kNoise:
      return "noise";
    case EventKind::kParameter:
      return "parameter";
    case EventKind::kPush:
      return "push";
    case EventKind::kReset:
      return "reset";
    case EventKind::kStandIn:
      return "stand_in";
    case EventKind::kRegrasp:
      return "regrasp";
    case EventKind::kFriction:
      return "friction";
  }
  return "";
}

}  // namespace regrasp
