#include "daemon/output/recorder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <new>

#include "core/journal/journal_text.h"

namespace regrasp {
namespace {

using namespace std::chrono_literals;
constexpr auto kFlushInterval = 200ms;    // what a kill can lose, of wall clock
constexpr auto kLongestWait = 200ms;      // of the I/O thread, for a disk that is slow
constexpr double kStateInterval_s = 0.5;  // of simulated time; to go half of it takes some 10 ms

}  // namespace

Recorder::Recorder(const std::filesystem::path& path, double rate_hz, const Journal& journal,
                   std::uint64_t run, std::uint64_t max_bytes)
    : path_(path),
      period_s_(1.0 / rate_hz),
      max_bytes_(max_bytes),
      last_run_(run),
      writer_(path.string()) {
  for (std::size_t i = 0; i < kRunTopics.size(); ++i)
    writer_.AddChannel(std::string(kRunTopics[i]), RunSchemaName(static_cast<RunTopic>(i)),
                       RunSchema(static_cast<RunTopic>(i), journal.config));
  Begin(journal, run);
  thread_ = std::thread([this] { Run(); });
}

Recorder::~Recorder() { Finish(); }

void Recorder::Begin(const Journal& journal, std::uint64_t run) {
  dt_ = journal.config.world.dt;
  Push(Start{journal, run});
}

void Recorder::Add(const JournalEntry& entry, std::uint64_t run) { Push(Entry{entry, run}); }

void Recorder::Add(const Event& event, std::uint64_t run) { Push(PublishedEvent{event, run}); }

void Recorder::Add(const Published& published) {
  if (published.run != last_run_) next_sample_ = 0;
  last_run_ = published.run;
  const Frame& frame = published.frame;
  const bool all = frame.tick >= next_sample_;
  if (all) next_sample_ = frame.tick + std::max<std::int64_t>(1, std::llround(period_s_ / dt_));
  {
    const std::lock_guard lock(mutex_);
    if (waiting_samples_ >= kMaxWaiting) {
      ++numbers_.dropped;
      return;
    }
    ++waiting_samples_;
  }
  Push(Sample{std::make_unique<const Published>(published), all});
}

void Recorder::Add(const JournalNews& mark) {
  Push(State{mark.entry.tick, mark.entry.state_hash, mark.run, mark.saved});
}

bool Recorder::TakeStateDue(const Published& published) {
  const std::int64_t tick = published.frame.tick;
  if (published.run == state_run_ && tick < next_state_) return false;
  state_run_ = published.run;
  next_state_ = tick + std::llround(kStateInterval_s / dt_);
  return true;
}

bool Recorder::IsJournal(const Item& item) {
  return std::holds_alternative<Start>(item) || std::holds_alternative<Entry>(item);
}

/// What cannot be kept until it is written would be missing in the file, which ends therefore.
void Recorder::Push(Item item) {
  {
    const std::lock_guard lock(mutex_);
    const bool journal = IsJournal(item);
    try {
      items_.push_back(std::move(item));
      if (journal) ++waiting_journal_;
    } catch (const std::bad_alloc&) {
      numbers_.failure = "no memory";
    }
  }
  wake_.notify_one();
}

void Recorder::AwaitJournal() {
  std::unique_lock lock(mutex_);
  written_.wait_for(lock, kLongestWait, [this] { return waiting_journal_ == 0; });
}

void Recorder::Finish() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

Recorder::Numbers Recorder::numbers() const {
  const std::lock_guard lock(mutex_);
  return numbers_;
}

void Recorder::Run() {
  auto flushed = std::chrono::steady_clock::now();
  bool ended = false;          // the file takes no more
  std::ptrdiff_t written = 0;  // of the journal
  for (bool more = true; more;) {
    std::deque<Item> items;
    {
      std::unique_lock lock(mutex_);
      waiting_journal_ -= written;
      if (written > 0) written_.notify_all();
      wake_.wait_for(lock, kFlushInterval, [this] { return finishing_ || !items_.empty(); });
      items.swap(items_);
      waiting_samples_ = 0;
      more = !finishing_ || !items.empty();
    }
    written = std::ranges::count_if(items, IsJournal);
    if (ended) continue;
    try {
      bool flush = !more || std::chrono::steady_clock::now() - flushed >= kFlushInterval;
      for (const Item& item : items) {
        Write(item);
        flush = flush || !std::holds_alternative<Sample>(item);  // the journal is safe at once
      }
      if (flush) {
        writer_.Flush();
        flushed = std::chrono::steady_clock::now();
      }
      const bool full = writer_.bytes() >= max_bytes_;
      ended = full || !more;
      if (ended) writer_.Finish();
      const std::lock_guard lock(mutex_);
      numbers_.messages = writer_.messages();
      numbers_.bytes = writer_.bytes();
      numbers_.full = full;
    } catch (const std::exception& e) {
      ended = true;
      const std::lock_guard lock(mutex_);
      numbers_.failure = e.what();
    }
  }
}

void Recorder::Write(const Item& item) {
  if (const auto* start = std::get_if<Start>(&item)) return WriteStart(*start);
  if (const auto* entry = std::get_if<Entry>(&item)) {
    Segment& segment = segments_.at(entry->run);
    return PutAlone(RunTopic::kCommands, Place(entry->run, entry->entry.tick),
                    EntryText(entry->entry, segment.config, segment.number, segment.commands++));
  }
  if (const auto* state = std::get_if<State>(&item)) {
    const auto segment = segments_.find(state->run);
    if (segment == segments_.end()) return;  // of a run before this file
    const RunSavedState saved{state->tick, segment->second.commands, state->state_hash,
                              segment->second.number, *state->bytes};
    return PutAlone(RunTopic::kSavedStates, Place(state->run, state->tick),
                    SavedStateText(saved, segment->second.config.world.dt));
  }
  if (const auto* event = std::get_if<PublishedEvent>(&item)) {
    if (!segments_.contains(event->run)) return;
    const RunPlace place = Place(event->run, event->event.tick);
    return Put(RunTopic::kEvents, place, RunEvent(event->event, place));
  }
  WriteSample(std::get<Sample>(item));
}

void Recorder::WriteSample(const Sample& sample) {
  const Frame& frame = sample.published->frame;
  if (!segments_.contains(sample.published->run)) return;
  const RunPlace place = Place(sample.published->run, frame.tick);
  const auto put = [&](RunTopic topic) {
    Put(topic, place, RunSample(topic, frame, sample.published->commands, place));
  };
  put(RunTopic::kState);
  if (!sample.all) return;
  for (const RunTopic topic :
       {RunTopic::kJoints, RunTopic::kContacts, RunTopic::kForces, RunTopic::kObject,
        RunTopic::kQuality, RunTopic::kTransforms, RunTopic::kContactScene})
    put(topic);
  if (frame.gait.active) put(RunTopic::kGait);
}

void Recorder::WriteStart(const Start& start) {
  Segment& segment = segments_[start.run];
  segment.number = static_cast<int>(segments_.size()) - 1;
  segment.offset_ns = segment.number == 0 ? 0 : last_time_;
  segment.config = start.journal.config;
  const RunPlace place = Place(start.run, 0);
  Put(RunTopic::kRun, place, ConfigText(segment.config, segment.number));
  Put(RunTopic::kScene, place, RunScene(place));
  for (const JournalEntry& entry : start.journal.entries)
    Put(RunTopic::kCommands, Place(start.run, entry.tick),
        EntryText(entry, segment.config, segment.number, segment.commands++));
}

RunPlace Recorder::Place(std::uint64_t run, std::int64_t tick) const {
  const Segment& segment = segments_.at(run);
  const double time_ns = std::round(static_cast<double>(tick) * segment.config.world.dt * 1e9);
  return {segment.config, segment.number, segment.offset_ns + static_cast<std::uint64_t>(time_ns)};
}

void Recorder::Put(RunTopic topic, const RunPlace& place, std::string_view text) {
  last_time_ = std::max(last_time_, place.time_ns);
  writer_.Write(static_cast<std::uint16_t>(static_cast<int>(topic) + 1), place.time_ns, text);
}

void Recorder::PutAlone(RunTopic topic, const RunPlace& place, std::string_view text) {
  writer_.Flush();
  Put(topic, place, text);
  writer_.Flush();
}

}  // namespace regrasp
