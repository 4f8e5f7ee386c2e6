// What the control thread tells: frames, events, jobs, the journal.

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/journal/saved_state.h"
#include "daemon/loop/control_loop.h"

namespace regrasp {

void ControlLoop::Mark(std::uint64_t request, ControlRequest::Part part) {
  CollectOutput();  // jobs that have ended before it go before it
  Publish();        // whoever is told of the mark also has its frame
  JournalNews news;
  news.kind = JournalNews::Kind::kMark;
  news.run = run_;
  news.request = request;
  news.entry.tick = session_->tick();
  news.entry.state_hash = session_->StateHash();
  news.state = session_->state();
  if (part == ControlRequest::Part::kState)
    news.saved = std::make_shared<const std::string>(SaveState(*session_));
  if (part == ControlRequest::Part::kFelt)
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

template <typename Queue, typename T>
bool ControlLoop::Put(Queue* ring, const T& value) {
  while (!ring->Push(value)) {
    if (config_.clock == ClockMode::kContinuous || stopping_.load(std::memory_order_relaxed))
      return false;
    output_.Notify();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

void ControlLoop::EmitEvent(const Event& event) {
  if (Put(&events_, PublishedEvent{event, run_, frames_published_ + 1}))
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
  // In this order whoever has a frame has the events that it shows, and whoever has a finished job
  // has its frame.
  for (const Event& event : events) EmitEvent(event);
  if (!events.empty() || !unsent_jobs_.empty()) Publish();
  if (publish_due_) return;  // the jobs wait for a frame that has room
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
  scratch_.number = ++frames_published_;
  publish_due_ = !Put(&frames_, scratch_);
  if (publish_due_) dropped_.fetch_add(1, std::memory_order_relaxed);
  output_.Notify();
}

void ControlLoop::Acknowledge() {
  if (acknowledged_.load(std::memory_order_relaxed) == taken_) return;
  acknowledged_.store(taken_, std::memory_order_release);
  output_.Notify();
}

}  // namespace regrasp
