// How a run gives way to another: a reset, or a checkpoint that is restored.

#include <algorithm>
#include <cstdio>
#include <exception>

#include "daemon/loop/control_loop.h"

namespace regrasp {
namespace {

constexpr std::int64_t kTicksPerSlice = 200;  // of a restore, between looks at the requests

}  // namespace

void ControlLoop::CancelWaiting(std::int64_t id, const char* why) {
  std::erase_if(commands_, [&](const Waiting& waiting) {
    const Command& command = waiting.request.command;
    const auto method = JobMethodOf(command.type);
    if (!method || (id != 0 && command.job != id)) return false;
    JobRecord job;
    job.id = command.job;
    job.method = *method;
    EndJob(job, JobState::kCancelled, why);
    return true;
  });
}

JobRecord ControlLoop::EndJob(JobRecord job, JobState state, const char* why) {
  job.state = state;
  job.end_tick = session_->tick();
  if (state == JobState::kCancelled) {
    job.explore.reason = ExploreReason::kCancelled;
    job.move.end = MoveEnd::kStopped;
  }
  std::snprintf(job.error, sizeof job.error, "%s", why);
  EmitJob(job);
  return job;
}

/// Ends the jobs of a run that another one takes the place of.
void ControlLoop::CancelEverything(const char* why) {
  CancelWaiting(0, why);
  commands_.clear();
  if (steps_left_ > 0) FinishStep(JobState::kCancelled, why);
  CollectOutput();
  session_->Snapshot(&scratch_.frame, false);
  const JobRecord& job = scratch_.frame.job;
  if (job.id != 0 && job.state == JobState::kRunning) EndJob(job, JobState::kCancelled, why);
}

void ControlLoop::Reset(const ControlRequest& request) {
  SessionConfig next = config_.session;
  if (request.object) next.model.object = *request.object;
  next.seed = request.seed;
  next.noise = session_->noise();
  next.parameters = session_->parameters();
  for (const Waiting& waiting : commands_) {
    const Command& earlier = waiting.request.command;
    if (earlier.type == CommandType::kNoise) next.noise = earlier.noise;
    if (earlier.type == CommandType::kParameter) SetParameter(&next.parameters, earlier);
  }
  next.parameters = ParametersAfterReset(next.parameters, request.object.get());
  CancelEverything("the simulation was reset");

  Event event;
  event.kind = EventKind::kReset;
  event.value = static_cast<double>(request.seed);
  try {
    auto fresh = std::make_unique<Session>(next);
    session_ = std::move(fresh);
    config_.session.model.object = next.model.object;
    ++run_;
    auto start = std::make_shared<RunStart>();
    start->journal.config = std::move(next);
    BeginJournal(std::move(start));
    std::snprintf(event.text, sizeof event.text, "reset: seed %llu, object %s",
                  static_cast<unsigned long long>(request.seed),
                  session_->config().model.object.name.c_str());
  } catch (const std::exception& e) {
    event.kind = EventKind::kRefused;
    event.tick = session_->tick();
    std::snprintf(event.text, sizeof event.text, "reset failed: %s", e.what());
  }
  EmitEvent(event);
  Publish();
  pacing_.Restart(Pacing::Clock::now());
}

void ControlLoop::BeginRestore(ControlRequest request) {
  ApplyWaiting();
  if (steps_left_ > 0) FinishStep(JobState::kCancelled, "a checkpoint is restored");
  step_ = JobRecord{};
  step_.id = request.job;
  step_.method = JobMethod::kRestore;
  step_.state = JobState::kRunning;
  step_.start_tick = session_->tick();
  publish_due_ = true;
  restoring_ = std::move(request);
  if (restoring_.session) return Adopt(std::move(restoring_.session));
  try {
    replay_ = std::make_unique<Replay>(
        std::shared_ptr<const Journal>(restoring_.checkpoint, &restoring_.checkpoint->journal));
  } catch (const std::exception& e) {
    EndRestore(JobState::kFailed, e.what());
  }
}

/// The present run goes on; the job that the checkpoint would have continued ends with the restore.
void ControlLoop::EndRestore(JobState state, const char* error) {
  replay_.reset();
  if (restoring_.command.job != 0) {
    JobRecord job;
    job.id = restoring_.command.job;
    job.method = restoring_.checkpoint->job.method;
    EndJob(job, state, "the checkpoint was not restored");
  }
  FinishStep(state, error);
  restoring_ = {};
}

void ControlLoop::RestoreSome() {
  const std::int64_t target = restoring_.checkpoint->tick;
  const std::int64_t tick = std::min(replay_->session().tick() + kTicksPerSlice, target);
  const bool equal = replay_->RunTo(tick) &&
                     (tick < target ||
                      (replay_->ApplyDue() && replay_->Compare(restoring_.checkpoint->state_hash)));
  step_.progress = target > 0 ? static_cast<double>(tick) / static_cast<double>(target) : 1;
  publish_due_ = true;
  if (!equal) {
    char text[sizeof step_.error];
    std::snprintf(text, sizeof text,
                  "the state differs at tick %lld: the checkpoint was saved by %s",
                  static_cast<long long>(replay_->divergence().tick),
                  restoring_.checkpoint->build == BuildIdentity() ? "this build, but was changed"
                                                                  : "another build");
    EndRestore(JobState::kFailed, text);
  } else if (tick == target) {
    Adopt(replay_->TakeSession());
  }
}

/// The restored session takes the place of the present one.
void ControlLoop::Adopt(std::unique_ptr<Session> session) {
  CancelEverything("a checkpoint was restored");
  session_ = std::move(session);
  replay_.reset();
  session_->TakeEvents();  // of the past
  session_->TakeFinishedJobs();
  ++run_;
  const Checkpoint& checkpoint = *restoring_.checkpoint;
  config_.session.model = checkpoint.journal.config.model;
  config_.session.world = checkpoint.journal.config.world;
  auto start = std::make_shared<RunStart>();
  start->journal = checkpoint.journal;
  start->restored = true;
  start->parameters = session_->parameters();
  start->noise = session_->noise();
  start->seed = restoring_.command.reseed ? restoring_.command.seed : session_->seed();
  BeginJournal(std::move(start));
  if (restoring_.command.job != 0 || restoring_.command.reseed) Apply(restoring_.command);
  FinishStep(JobState::kDone, "");
  Event event;
  event.kind = EventKind::kReset;
  event.tick = session_->tick();
  event.value = static_cast<double>(session_->seed());
  std::snprintf(event.text, sizeof event.text, "checkpoint %s restored", checkpoint.name.c_str());
  EmitEvent(event);
  Publish();
  restoring_ = {};
}

}  // namespace regrasp
