#include "daemon/loop/control_loop.h"

#include <algorithm>
#include <cstdio>
#include <exception>

#include "core/journal/saved_state.h"

namespace regrasp {
namespace {

constexpr int kTicksPerFrame = 10;
constexpr std::int64_t kTicksPerSlice = 200;  // of a restore, between looks at the requests

template <std::size_t N>
void CopyText(char (&target)[N], const char* text) {
  std::snprintf(target, N, "%s", text);
}

}  // namespace

void SetParameter(Parameters* parameters, const Command& command) {
  SetByUser(ParameterTable()[static_cast<std::size_t>(command.parameter)], command.value,
            parameters);
}

Parameters ParametersAfterReset(Parameters parameters, const ObjectModel* new_object) {
  if (new_object) {
    parameters.object.friction = new_object->friction;
    parameters.object.mass_kg = new_object->mass;
  }
  return parameters;
}

ControlLoop::ControlLoop(ControlConfig config)
    : config_(std::move(config)),
      session_(std::make_unique<Session>(config_.session)),
      pacing_(config_.session.world.dt, config_.speed),
      paused_(config_.paused) {
  commands_.reserve(512);
  unsent_jobs_.reserve(512);
  auto start = std::make_shared<RunStart>();
  start->journal.config = config_.session;
  BeginJournal(std::move(start));
  Publish();  // the first frame is there before anybody can ask
  thread_ = std::thread([this] { Run(); });
}

ControlLoop::~ControlLoop() {
  stopping_.store(true);
  input_.Notify();
  thread_.join();
}

std::uint64_t ControlLoop::Post(ControlRequest request) {
  if (!requests_.Push({std::move(request), posted_ + 1})) return 0;
  input_.Notify();
  return ++posted_;
}

void ControlLoop::Run() {
  pacing_.Restart(Pacing::Clock::now());
  while (!stopping_.load(std::memory_order_relaxed)) {
    input_.Clear();
    TakeRequests();
    if (replay_) {
      pulse_.fetch_add(1, std::memory_order_relaxed);
      RestoreSome();
      CollectOutput();
      if (publish_due_) Publish();
      Acknowledge();
      pacing_.Restart(Pacing::Clock::now());
      continue;
    }
    const bool faulted = session_->state() == SessionState::kFaulted;
    // Nothing moves any more: commands are answered (refused), the clock stands.
    if (faulted && steps_left_ > 0) FinishStep(JobState::kFailed, "the simulation has faulted");
    if (faulted || (config_.clock == ClockMode::kLockstep && !paused_)) ApplyWaiting();
    if (!Advancing()) {
      StandStill();
      continue;
    }
    if (!paused_) {
      if (const auto due = pacing_.Due(Pacing::Clock::now())) {
        if (publish_due_) Publish();
        if (commands_.empty()) Acknowledge();
        input_.WaitUntil(due);
        if (Pacing::Clock::now() < *due) continue;
      }
    }
    if (!paused_) lateness_.Add(pacing_.Lateness(Pacing::Clock::now()));
    ApplyWaiting();
    TickOnce();
    Acknowledge();
  }
}

/// Whether the next tick comes by itself.
bool ControlLoop::Advancing() const {
  if (session_->state() == SessionState::kFaulted) return false;
  if (steps_left_ > 0) return true;
  return !paused_ && (config_.clock == ClockMode::kContinuous || session_->job_running());
}

/// Tells what there is to tell and sleeps until asked.
void ControlLoop::StandStill() {
  if (session_->state() != SessionState::kFaulted) pulse_.fetch_add(1, std::memory_order_relaxed);
  CollectOutput();
  if (publish_due_) Publish();
  Acknowledge();
  // What the rings could not take is offered again soon.
  const bool retry = publish_due_ || !unsent_jobs_.empty() || !unsent_news_.empty();
  using namespace std::chrono_literals;
  input_.WaitUntil(retry ? std::optional(Pacing::Clock::now() + 1ms) : std::nullopt);
  pacing_.Restart(Pacing::Clock::now());
}

void ControlLoop::TakeRequests() {
  Waiting taken;
  while (commands_.size() < 512 && requests_.Pop(&taken)) {
    taken_ = taken.number;
    switch (taken.request.kind) {
      case ControlRequest::Kind::kCommand:
        commands_.push_back(std::move(taken));
        break;
      case ControlRequest::Kind::kReset:
        Reset(taken.request);
        break;
      case ControlRequest::Kind::kPause:
        paused_ = true;
        publish_due_ = true;
        break;
      case ControlRequest::Kind::kResume:
        if (steps_left_ > 0) FinishStep(JobState::kCancelled, "resumed");
        paused_ = false;
        publish_due_ = true;
        pacing_.Restart(Pacing::Clock::now());
        break;
      case ControlRequest::Kind::kStep:
        step_ = JobRecord{};
        step_.id = taken.request.job;
        step_.method = JobMethod::kStep;
        step_.state = JobState::kRunning;
        step_.start_tick = session_->tick();
        steps_left_ = steps_total_ = taken.request.ticks;
        step_until_job_ends_ = taken.request.until_job_ends;
        if (!paused_ && config_.clock == ClockMode::kContinuous)
          FinishStep(JobState::kFailed, "the simulation is not paused");
        break;
      case ControlRequest::Kind::kCancelStep:
        if (step_.id != taken.request.job) break;
        if (replay_) EndRestore(JobState::kCancelled, "");
        if (steps_left_ > 0) FinishStep(JobState::kCancelled, "");
        break;
      case ControlRequest::Kind::kMark:
        ApplyWaiting();  // what was accepted before belongs to it
        Mark(taken.number);
        break;
      case ControlRequest::Kind::kRestore:
        BeginRestore(std::move(taken.request));
        break;
    }
  }
  waiting_.store(commands_.size(), std::memory_order_relaxed);
}

void ControlLoop::ApplyWaiting() {
  if (commands_.empty()) return;
  for (const Waiting& waiting : commands_) Apply(waiting.request.command);
  commands_.clear();
  waiting_.store(0, std::memory_order_relaxed);
  publish_due_ = true;
}

void ControlLoop::Apply(const Command& command) {
  JournalNews news;
  news.entry.tick = session_->tick();
  if (session_->Apply(command).kind != Verdict::Kind::kAllowed) return;
  news.run = run_;
  news.entry.command = command;
  news.entry.state_hash = session_->StateHash();
  ++applied_;
  EmitNews(std::move(news));
}

void ControlLoop::Mark(std::uint64_t request) {
  CollectOutput();  // jobs that have ended before it go before it
  Publish();        // whoever is told of the mark also has its frame
  JournalNews news;
  news.kind = JournalNews::Kind::kMark;
  news.run = run_;
  news.request = request;
  news.entry.tick = session_->tick();
  news.entry.state_hash = session_->StateHash();
  news.state = session_->state();
  news.saved = std::make_shared<const std::string>(SaveState(*session_));
  news.felt = std::make_shared<const FeltSurface>(session_->felt_surface());
  session_->Snapshot(&scratch_.frame, false);
  if (session_->job_running()) news.job = scratch_.frame.job;
  EmitNews(std::move(news));
}

void ControlLoop::BeginJournal(std::shared_ptr<const RunStart> start) {
  JournalNews news;
  news.kind = JournalNews::Kind::kBegin;
  applied_ = start->journal.entries.size();
  news.run = run_;
  news.start = std::move(start);
  EmitNews(std::move(news));
}

/// Ends the jobs of a run that another one takes the place of.
void ControlLoop::CancelEverything(const char* why) {
  const std::int64_t tick = session_->tick();
  for (const Waiting& waiting : commands_) {
    if (const auto method = JobMethodOf(waiting.request.command.type)) {
      JobRecord job;
      job.id = waiting.request.command.job;
      job.method = *method;
      job.state = JobState::kCancelled;
      job.end_tick = tick;
      CopyText(job.error, why);
      EmitJob(job);
    }
  }
  commands_.clear();
  if (steps_left_ > 0) FinishStep(JobState::kCancelled, why);
  CollectOutput();
  session_->Snapshot(&scratch_.frame, false);
  if (JobRecord job = scratch_.frame.job; job.id != 0 && job.state == JobState::kRunning) {
    job.state = JobState::kCancelled;
    job.end_tick = tick;
    job.explore.reason = ExploreReason::kCancelled;
    job.move.end = MoveEnd::kStopped;
    CopyText(job.error, why);
    EmitJob(job);
  }
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
  publish_due_ = true;
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
    job.state = state;
    CopyText(job.error, "the checkpoint was not restored");
    EmitJob(job);
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
  std::snprintf(event.text, sizeof event.text, "checkpoint %.60s restored",
                checkpoint.name.c_str());
  EmitEvent(event);
  restoring_ = {};
}

void ControlLoop::TickOnce() {
  const auto start = Pacing::Clock::now();
  session_->Tick();
  tick_times_.Add(std::chrono::duration<double>(Pacing::Clock::now() - start).count());
  pacing_.Ticked();
  pulse_.fetch_add(1, std::memory_order_relaxed);
  if (steps_left_ > 0) {
    --steps_left_;
    step_.progress = 1.0 - static_cast<double>(steps_left_) / static_cast<double>(steps_total_);
    if (steps_left_ == 0 || (step_until_job_ends_ && !session_->job_running()))
      FinishStep(JobState::kDone, "");
  }
  if (session_->tick() % kTicksPerFrame == 0) publish_due_ = true;
  CollectOutput();
  if (publish_due_) Publish();
}

void ControlLoop::FinishStep(JobState state, const char* error) {
  step_.state = state;
  step_.end_tick = session_->tick();
  CopyText(step_.error, error);
  if (state == JobState::kDone) step_.progress = 1;
  steps_left_ = 0;
  EmitJob(step_);
}

void ControlLoop::EmitJob(const JobRecord& job) {
  unsent_jobs_.push_back(job);
  publish_due_ = true;
}

void ControlLoop::EmitNews(JournalNews news) {
  if (unsent_news_.empty() && news_.Push(news))
    output_.Notify();
  else
    unsent_news_.push_back(std::move(news));
}

void ControlLoop::EmitEvent(const Event& event) {
  if (events_.Push({event, run_}))
    output_.Notify();
  else
    dropped_.fetch_add(1, std::memory_order_relaxed);
}

void ControlLoop::CollectOutput() {
  if (!unsent_news_.empty()) {
    const auto kept = std::find_if(unsent_news_.begin(), unsent_news_.end(),
                                   [this](const JournalNews& news) { return !news_.Push(news); });
    if (kept != unsent_news_.begin()) output_.Notify();
    unsent_news_.erase(unsent_news_.begin(), kept);
  }
  for (const JobRecord& job : session_->TakeFinishedJobs()) EmitJob(job);
  const auto events = session_->TakeEvents();
  // The frame first: whoever has seen an event or a finished job also has the frame that shows it.
  if (!events.empty() || !unsent_jobs_.empty()) Publish();
  for (const Event& event : events) EmitEvent(event);
  const auto sent = std::find_if(unsent_jobs_.begin(), unsent_jobs_.end(),
                                 [this](const JobRecord& job) { return !jobs_.Push(job); });
  if (sent != unsent_jobs_.begin()) output_.Notify();
  unsent_jobs_.erase(unsent_jobs_.begin(), sent);
}

void ControlLoop::Publish() {
  session_->Snapshot(&scratch_.frame, true);
  scratch_.paused = paused_;
  scratch_.advancing = Advancing();
  scratch_.step = step_;
  scratch_.run = run_;
  scratch_.commands = applied_;
  publish_due_ = !frames_.Push(scratch_);
  if (publish_due_) dropped_.fetch_add(1, std::memory_order_relaxed);
  output_.Notify();
}

void ControlLoop::Acknowledge() {
  if (acknowledged_.load(std::memory_order_relaxed) == taken_) return;
  acknowledged_.store(taken_, std::memory_order_release);
  output_.Notify();
}

}  // namespace regrasp
