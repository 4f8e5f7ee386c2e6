#include "daemon/loop/control_loop.h"

namespace regrasp {
namespace {

constexpr int kTicksPerFrame = 10;

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
        if (taken.request.command.type == CommandType::kStop)
          CancelWaiting(0, "stopped before it began");
        if (taken.request.command.type == CommandType::kCancelJob)
          CancelWaiting(taken.request.command.job, "cancelled before it began");
        commands_.push_back(std::move(taken));
        break;
      case ControlRequest::Kind::kReset:
        Reset(taken.request);
        break;
      case ControlRequest::Kind::kPause:
        if (steps_left_ > 0) FinishStep(JobState::kCancelled, "paused");
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
        if (steps_left_ == 0) break;
        ApplyWaiting();  // as its next tick would have
        FinishStep(JobState::kCancelled, "");
        break;
      case ControlRequest::Kind::kMark:
        ApplyWaiting();  // what was accepted before belongs to it
        Mark(taken.number, taken.request.part);
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
  if (state == JobState::kDone) step_.progress = 1;
  steps_left_ = 0;
  step_ = EndJob(step_, state, error);
}

}  // namespace regrasp
