#include <cmath>
#include <cstdio>

#include "core/session/few_fingers.h"
#include "core/session/session_impl.h"

namespace regrasp {
namespace {

/// Whether a job may start now.
Verdict CheckStart(const JobInfo& job, SessionState state, bool job_running) {
  using Kind = Verdict::Kind;
  if (job_running) return {Kind::kBusy, "another job is running", "regrasp stop"};
  if (state == job.from) return {};
  if (job.from == SessionState::kIdle && state == SessionState::kHolding)
    return {Kind::kBadState, "the hand already holds the object", "regrasp release"};
  if (job.from == SessionState::kIdle)
    return {Kind::kBadState, "the object is not presented to the hand", "regrasp reset"};
  const bool lost = state == SessionState::kDropped || state == SessionState::kFaulted;
  return {Kind::kBadState, "the hand does not hold the object",
          lost ? "regrasp reset" : "regrasp grasp"};
}

}  // namespace

Verdict Check(CommandType type, SessionState state, bool job_running) {
  using Kind = Verdict::Kind;
  if (const JobInfo* job = FindJob(&JobInfo::command, type))
    return CheckStart(*job, state, job_running);
  if (state == SessionState::kFaulted)
    return {Kind::kBadState, "the simulation is faulted", "regrasp reset"};
  if (type == CommandType::kPush &&
      (state == SessionState::kDropped || state == SessionState::kIdle))
    return {Kind::kBadState, "the hand does not hold the object",
            state == SessionState::kDropped ? "regrasp reset" : "regrasp grasp"};
  return {};
}

Verdict CheckMeasure(const Parameters& parameters, JobMethod method, Criterion criterion) {
  const bool exploring_gait =
      method == JobMethod::kRotate && parameters.gait.mode == GaitMode::kExploring;
  if (!exploring_gait && method != JobMethod::kExplore) return {};
  if (InfoOf(criterion).takes_turn_axis && !exploring_gait &&
      TurnAxisOf(parameters.exploration).isZero(0))
    return {Verdict::Kind::kBadState,
            "what is maximised is of a turn about an axis, and exploration.turn_axis is zero",
            "regrasp param set exploration.turn_axis 0,0,-1"};
  if (exploring_gait) criterion = Criterion::kStability;  // as one of its fingers does
  if (MayMaximise(criterion, parameters.control)) return {};
  return {Verdict::Kind::kBadState,
          "the selected stability measure is too slow for a tick: exploration cannot maximise it",
          "regrasp param reset control.stability_measure"};
}

void Session::Impl::Enter(SessionState next) {
  if (state == next) return;
  state = next;
  log.Emit(tick, EventKind::kState, -1, static_cast<double>(next), "%s", Name(next).data());
}

void Session::Impl::StartJob(const Command& command, JobMethod method) {
  job = JobRecord();
  job.id = command.job;
  job.method = method;
  job.state = JobState::kRunning;
  job.start_tick = tick;
  log.Emit(tick, EventKind::kJobStarted, command.finger, static_cast<double>(job.id),
           "job %lld: %s", static_cast<long long>(job.id), Name(method).data());
}

void Session::Impl::FinishJob(JobState end, const char* error) {
  if (!job_running()) return;
  job.state = end;
  job.end_tick = tick;
  if (end == JobState::kDone) job.progress = 1;
  std::snprintf(job.error, sizeof(job.error), "%s", error);
  log.Emit(tick, EventKind::kJobFinished, job.explore.finger, static_cast<double>(job.id),
           "job %lld: %s%s%s", static_cast<long long>(job.id), Name(end).data(), *error ? ": " : "",
           error);
  finished.push_back(job);
}

void Session::Impl::Finish(const ActivityStep& step) {
  FinishJob(step.job, step.error);
  Enter(step.next);
}

Verdict Session::Impl::Refuse(const Command& command, const Verdict& verdict) {
  if (const auto method = JobMethodOf(command.type)) {
    JobRecord refused;
    refused.id = command.job;
    refused.method = *method;
    refused.state = JobState::kFailed;
    refused.start_tick = refused.end_tick = tick;
    refused.explore.finger = command.finger;
    refused.move.offset_m = command.offset_W;
    refused.move.rotation_rad = command.rotation_W;
    std::snprintf(refused.error, sizeof(refused.error), "%s", verdict.reason);
    finished.push_back(refused);
  }
  log.Emit(tick, EventKind::kRefused, command.finger, static_cast<double>(command.job),
           "refused: %s", verdict.reason);
  return verdict;
}

Verdict Session::Impl::StartActivity(const Command& command, JobMethod method) {
  const SessionState next = FindJob(&JobInfo::id, method)->state;
  Activity& activity = *Running(next);
  const ActivityContext context = Context();
  if (const Verdict refusal = activity.MayStart(command, context);
      refusal.kind != Verdict::Kind::kAllowed)
    return Refuse(command, refusal);
  StartJob(command, method);
  activity.Start(command, context);
  Enter(next);
  return {};
}

Verdict Session::Impl::Apply(const Command& command) {
  const Verdict verdict = Check(command.type, state, job_running());
  if (verdict.kind != Verdict::Kind::kAllowed) return Refuse(command, verdict);
  if (const auto method = JobMethodOf(command.type)) {
    const Verdict fit = CheckMeasure(parameters, *method, command.criterion);
    if (fit.kind != Verdict::Kind::kAllowed) return Refuse(command, fit);
    const Verdict enough = CheckFingers(config.model.hand, parameters, command);
    if (enough.kind != Verdict::Kind::kAllowed) return Refuse(command, enough);
    return StartActivity(command, *method);
  }
  switch (command.type) {
    case CommandType::kStop:
      StopJob();
      break;
    case CommandType::kCancelJob:
      if (job.id == command.job) StopJob();
      break;
    case CommandType::kNoise:
      sensors.SetNoise(command.noise);
      log.Emit(tick, EventKind::kNoise, -1, 0, "noise %s", NoiseName(command.noise).data());
      break;
    case CommandType::kPush:
      Push(command);
      break;
    case CommandType::kParameter: {
      Parameters next = parameters;
      SetByUser(ParameterTable()[command.parameter], command.value, &next);
      const Verdict fit =
          job_running() ? CheckMeasure(next, job.method, job.explore.criterion) : Verdict();
      if (fit.kind != Verdict::Kind::kAllowed) return Refuse(command, fit);
      SetParameter(command);
      break;
    }
    case CommandType::kBranch:
      Branch(command);
      break;
    default:
      break;  // starts a job: done above
  }
  return verdict;
}

void Session::Impl::Push(const Command& command) {
  push_until = tick + static_cast<std::int64_t>(std::lround(command.duration_s / dt));
  world.SetPush(command.force_W);
  const double force = command.force_W.norm();
  log.Emit(tick, EventKind::kPush, -1, force, "push %.3g N for %.3g s", force, command.duration_s);
}

void Session::Impl::ApplyParameters() {
  world.SetFriction(parameters.object.friction);
  world.SetMass(parameters.object.mass_kg);
  world.SetGravity(parameters.gravity_W);
  CountOn();
}

void Session::Impl::SetParameter(const Command& command) {
  const ParameterInfo& info = ParameterTable()[command.parameter];
  SetByUser(info, command.value, &parameters);
  ApplyParameters();
  const Vector3d& v = command.value;
  const auto name = static_cast<int>(info.name.size());
  const std::string_view word =
      info.type == ParameterType::kWord      ? info.words[static_cast<std::size_t>(v[0])]
      : info.type == ParameterType::kBoolean ? std::string_view(v[0] != 0 ? "true" : "false")
                                             : std::string_view();
  if (!word.empty())
    log.Emit(tick, EventKind::kParameter, -1, v[0], "%.*s = %.*s", name, info.name.data(),
             static_cast<int>(word.size()), word.data());
  else if (info.type == ParameterType::kVector)
    log.Emit(tick, EventKind::kParameter, -1, v[0], "%.*s = [%.6g, %.6g, %.6g]", name,
             info.name.data(), v[0], v[1], v[2]);
  else
    log.Emit(tick, EventKind::kParameter, -1, v[0], "%.*s = %.6g", name, info.name.data(), v[0]);
}

void Session::Impl::Branch(const Command& command) {
  if (command.job != 0 && job_running()) job.id = command.job;
  if (!command.reseed) return;
  seed = command.seed;
  sensors.Reseed(seed);
  log.Emit(tick, EventKind::kNoise, -1, static_cast<double>(seed), "noise goes on from seed %llu",
           static_cast<unsigned long long>(seed));
}

void Session::Impl::StopJob() {
  if (!job_running()) return;
  if (const ActivityStep step = Running(state)->Stop(Context()); step.ended()) Finish(step);
}

}  // namespace regrasp
