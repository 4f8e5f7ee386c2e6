#include <cmath>

#include "core/session/session_impl.h"

namespace regrasp {

Verdict Check(CommandType type, SessionState state, bool job_running) {
  using Kind = Verdict::Kind;
  const bool faulted = state == SessionState::kFaulted;
  switch (type) {
    case CommandType::kReset:
      return {};
    case CommandType::kStop:
    case CommandType::kCancelJob:
    case CommandType::kNoise:
    case CommandType::kParameter:
    case CommandType::kBranch:
      if (faulted) return {Kind::kBadState, "the simulation is faulted", "regrasp reset"};
      return {};
    case CommandType::kPush:
      if (faulted) return {Kind::kBadState, "the simulation is faulted", "regrasp reset"};
      if (state == SessionState::kDropped || state == SessionState::kIdle)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp grasp"};
      return {};
    case CommandType::kGrasp:
      if (job_running) return {Kind::kBusy, "another job is running", "regrasp stop"};
      if (state == SessionState::kHolding)
        return {Kind::kBadState, "the hand already holds the object", "regrasp release"};
      if (state != SessionState::kIdle)
        return {Kind::kBadState, "the object is not presented to the hand", "regrasp reset"};
      return {};
    case CommandType::kRelease:
      if (job_running) return {Kind::kBusy, "another job is running", "regrasp stop"};
      if (state != SessionState::kHolding)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp grasp"};
      return {};
    case CommandType::kExplore:
    case CommandType::kRotate:
    case CommandType::kMove:
      if (job_running) return {Kind::kBusy, "another job is running", "regrasp stop"};
      if (state == SessionState::kDropped || faulted)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp reset"};
      if (state != SessionState::kHolding)
        return {Kind::kBadState, "the hand does not hold the object", "regrasp grasp"};
      return {};
  }
  return {};
}

void Session::Impl::Enter(SessionState next) {
  if (state == next) return;
  state = next;
  Emit(EventKind::kState, -1, static_cast<double>(next), "%s", Name(next).data());
}

void Session::Impl::StartJob(const Command& command, JobMethod method) {
  job = JobRecord();
  job.id = command.job;
  job.method = method;
  job.state = JobState::kRunning;
  job.start_tick = tick;
  Emit(EventKind::kJobStarted, command.finger, static_cast<double>(job.id), "job %lld: %s",
       static_cast<long long>(job.id), Name(method).data());
}

void Session::Impl::FinishJob(JobState end, const char* error) {
  if (!job_running()) return;
  job.state = end;
  job.end_tick = tick;
  if (end == JobState::kDone) job.progress = 1;
  std::snprintf(job.error, sizeof(job.error), "%s", error);
  Emit(EventKind::kJobFinished, job.explore.finger, static_cast<double>(job.id), "job %lld: %s%s%s",
       static_cast<long long>(job.id), Name(end).data(), *error ? ": " : "", error);
  finished.push_back(job);
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
  Emit(EventKind::kRefused, command.finger, static_cast<double>(command.job), "refused: %s",
       verdict.reason);
  return verdict;
}

Verdict Session::Impl::MayExplore(int finger) {
  constexpr auto kRefused = Verdict::Kind::kBadState;
  if (finger < 0 || finger >= hand.num_fingers())
    return {kRefused, "no such finger", "regrasp contacts"};
  if (estimator.estimate().fingers[finger].in_contact) return {};
  std::snprintf(refusal_text, sizeof(refusal_text), "%s does not touch the object",
                hand.fingers[finger].name.c_str());
  return {kRefused, refusal_text, "regrasp quality"};
}

Verdict Session::Impl::Apply(const Command& command) {
  const Verdict verdict = Check(command.type, state, job_running());
  if (verdict.kind != Verdict::Kind::kAllowed) return Refuse(command, verdict);
  switch (command.type) {
    case CommandType::kGrasp:
      if (!world->stand_in())
        return Refuse(command, {Verdict::Kind::kBadState, "the object is not presented to the hand",
                                "regrasp reset"});
      StartJob(command, JobMethod::kGrasp);
      grasp.Start(estimator.estimate());
      Enter(SessionState::kGrasping);
      break;
    case CommandType::kRelease:
      StartJob(command, JobMethod::kRelease);
      release_tick = tick;
      break;
    case CommandType::kExplore:
      if (const Verdict refusal = MayExplore(command.finger);
          refusal.kind != Verdict::Kind::kAllowed)
        return Refuse(command, refusal);
      StartJob(command, JobMethod::kExplore);
      StartExploration(command);
      break;
    case CommandType::kRotate:
      StartJob(command, JobMethod::kRotate);
      StartRotation(command);
      break;
    case CommandType::kMove:
      StartJob(command, JobMethod::kMove);
      StartMove(command);
      break;
    case CommandType::kStop:
      StopJob();
      break;
    case CommandType::kCancelJob:
      if (job_running() && job.id == command.job) StopJob();
      break;
    case CommandType::kNoise:
      noise = command.noise;
      sensors->SetNoise(noise);
      Emit(EventKind::kNoise, -1, 0, "noise %s", NoiseName(noise).data());
      break;
    case CommandType::kPush:
      push_until = tick + static_cast<std::int64_t>(std::lround(command.duration_s / dt));
      world->SetPush(command.force_W);
      Emit(EventKind::kPush, -1, command.force_W.norm(), "push %.3g N for %.3g s",
           command.force_W.norm(), command.duration_s);
      break;
    case CommandType::kParameter:
      SetParameter(command);
      break;
    case CommandType::kBranch:
      Branch(command);
      break;
    case CommandType::kReset:
      if (command.object) {
        object = command.object;
        parameters.object.friction = object->friction;
        parameters.object.mass_kg = object->mass;
      }
      FinishJob(JobState::kCancelled, "reset");
      Build(command.seed);
      Emit(EventKind::kReset, -1, static_cast<double>(seed), "reset: seed %llu, object %s",
           static_cast<unsigned long long>(seed), object->name.c_str());
      break;
  }
  return verdict;
}

void Session::Impl::SetParameter(const Command& command) {
  const ParameterInfo& info = ParameterTable()[command.parameter];
  double* p = info.access(parameters);
  for (int k = 0; k < info.size; ++k) p[k] = command.value[k];
  world->SetFriction(parameters.object.friction);
  world->SetMass(parameters.object.mass_kg);
  world->SetGravity(parameters.gravity_W);
  Emit(EventKind::kParameter, -1, command.value[0], "%s = %.6g", info.name.data(),
       command.value[0]);
}

void Session::Impl::Branch(const Command& command) {
  if (command.job != 0 && job_running()) job.id = command.job;
  if (!command.reseed) return;
  seed = command.seed;
  sensors->Reseed(seed);
  Emit(EventKind::kNoise, -1, static_cast<double>(seed), "noise goes on from seed %llu",
       static_cast<unsigned long long>(seed));
}

void Session::Impl::StopJob() {
  if (!job_running()) return;
  switch (job.method) {
    case JobMethod::kGrasp:
      FinishJob(JobState::kCancelled, "");
      if (grasp.phase() < GraspSequence::Phase::kAlone) {
        ToPosture(q_open);
        Enter(SessionState::kIdle);
      } else {
        Enter(SessionState::kHolding);
      }
      break;
    case JobMethod::kExplore:
      job.explore.reason = ExploreReason::kCancelled;
      gait.active() ? gait.Stop() : exploration.Stop();
      break;
    case JobMethod::kRotate:
      gait.Stop();
      break;
    case JobMethod::kMove:
      move.Stop();
      break;
    default:
      break;  // letting go takes half a second and is not interrupted
  }
}

}  // namespace regrasp
