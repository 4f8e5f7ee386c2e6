#include "daemon/control_loop.h"

#include <algorithm>
#include <cstdio>
#include <exception>

namespace regrasp {
namespace {

constexpr int kTicksPerFrame = 10;

template <std::size_t N>
void CopyText(char (&target)[N], const char* text) {
  std::snprintf(target, N, "%s", text);
}

}  // namespace

void SetParameter(Parameters* parameters, const Command& command) {
  const ParameterInfo& info = ParameterTable()[static_cast<std::size_t>(command.parameter)];
  double* target = info.access(*parameters);
  for (int i = 0; i < info.size; ++i) target[i] = command.value[i];
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
    const bool faulted = session_->state() == SessionState::kFaulted;
    if (faulted) {
      // Nothing moves any more: commands are answered (refused), the clock stands.
      if (steps_left_ > 0) FinishStep(JobState::kFailed, "the simulation has faulted");
      ApplyWaiting();
    }
    const bool ticking = !faulted && (!paused_ || steps_left_ > 0);
    if (!ticking) {
      if (!faulted) pulse_.fetch_add(1, std::memory_order_relaxed);
      CollectOutput();
      if (publish_due_) Publish();
      Acknowledge();
      // What the rings could not take is offered again soon; otherwise sleep until asked.
      const bool retry = publish_due_ || !unsent_jobs_.empty();
      using namespace std::chrono_literals;
      input_.WaitUntil(retry ? std::optional(Pacing::Clock::now() + 1ms) : std::nullopt);
      pacing_.Restart(Pacing::Clock::now());
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

void ControlLoop::TakeRequests() {
  Waiting taken;
  while (commands_.size() < 512 && requests_.Pop(&taken)) {
    taken_ = taken.number;
    switch (taken.request.kind) {
      case ControlRequest::Kind::kCommand:
        if (taken.request.command.type == CommandType::kReset)
          Reset(taken.request.command);
        else
          commands_.push_back(std::move(taken));
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
        if (!paused_) FinishStep(JobState::kFailed, "the simulation is not paused");
        break;
      case ControlRequest::Kind::kCancelStep:
        if (steps_left_ > 0 && step_.id == taken.request.job) FinishStep(JobState::kCancelled, "");
        break;
    }
  }
  waiting_.store(commands_.size(), std::memory_order_relaxed);
}

void ControlLoop::ApplyWaiting() {
  if (commands_.empty()) return;
  for (const Waiting& waiting : commands_) session_->Apply(waiting.request.command);
  commands_.clear();
  waiting_.store(0, std::memory_order_relaxed);
  publish_due_ = true;
}

void ControlLoop::Reset(const Command& command) {
  const std::int64_t tick = session_->tick();
  SessionConfig next = config_.session;
  if (command.object) next.model.object = *command.object;
  next.seed = command.seed;
  next.noise = session_->noise();
  next.parameters = session_->parameters();
  for (const Waiting& waiting : commands_) {
    const Command& earlier = waiting.request.command;
    if (earlier.type == CommandType::kNoise) next.noise = earlier.noise;
    if (earlier.type == CommandType::kParameter) SetParameter(&next.parameters, earlier);
    if (const auto method = JobMethodOf(earlier.type)) {
      JobRecord job;
      job.id = earlier.job;
      job.method = *method;
      job.state = JobState::kCancelled;
      job.end_tick = tick;
      CopyText(job.error, "the simulation was reset");
      EmitJob(job);
    }
  }
  commands_.clear();
  next.parameters = ParametersAfterReset(next.parameters, command.object.get());
  if (steps_left_ > 0) FinishStep(JobState::kCancelled, "the simulation was reset");
  CollectOutput();
  session_->Snapshot(&scratch_.frame, false);
  if (JobRecord job = scratch_.frame.job; job.id != 0 && job.state == JobState::kRunning) {
    job.state = JobState::kCancelled;
    job.end_tick = tick;
    job.explore.reason = ExploreReason::kCancelled;
    CopyText(job.error, "the simulation was reset");
    EmitJob(job);
  }

  Event event;
  event.kind = EventKind::kReset;
  event.value = static_cast<double>(command.seed);
  try {
    auto fresh = std::make_unique<Session>(next);
    session_ = std::move(fresh);
    config_.session.model.object = next.model.object;
    ++run_;
    std::snprintf(event.text, sizeof event.text, "reset: seed %llu, object %s",
                  static_cast<unsigned long long>(next.seed), session_->object_name().c_str());
  } catch (const std::exception& e) {
    event.kind = EventKind::kRefused;
    event.tick = tick;
    std::snprintf(event.text, sizeof event.text, "reset failed: %s", e.what());
  }
  EmitEvent(event);
  publish_due_ = true;
  pacing_.Restart(Pacing::Clock::now());
}

void ControlLoop::TickOnce() {
  session_->Tick();
  pacing_.Ticked();
  pulse_.fetch_add(1, std::memory_order_relaxed);
  if (steps_left_ > 0) {
    --steps_left_;
    step_.progress = 1.0 - static_cast<double>(steps_left_) / static_cast<double>(steps_total_);
    if (steps_left_ == 0) FinishStep(JobState::kDone, "");
  }
  if (session_->tick() % kTicksPerFrame == 0) publish_due_ = true;
  CollectOutput();
  if (publish_due_) Publish();
}

void ControlLoop::FinishStep(JobState state, const char* error) {
  step_.state = state;
  step_.end_tick = session_->tick();
  CopyText(step_.error, error);
  steps_left_ = 0;
  EmitJob(step_);
}

void ControlLoop::EmitJob(const JobRecord& job) {
  unsent_jobs_.push_back(job);
  publish_due_ = true;
}

void ControlLoop::EmitEvent(const Event& event) {
  if (events_.Push({event, run_}))
    output_.Notify();
  else
    dropped_.fetch_add(1, std::memory_order_relaxed);
}

void ControlLoop::CollectOutput() {
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
  scratch_.step = step_;
  scratch_.run = run_;
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
