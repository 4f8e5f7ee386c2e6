#include "daemon/output/recorder.h"

#include <chrono>
#include <cmath>
#include <exception>
#include <new>

#include "core/journal/journal_text.h"

namespace regrasp {
namespace {

using namespace std::chrono_literals;
constexpr auto kFlushInterval = 200ms;  // what a kill can lose, of wall clock

}  // namespace

Recorder::Recorder(const std::filesystem::path& path, double rate_hz, const Journal& journal,
                   std::uint64_t run, std::uint64_t max_bytes)
    : path_(path),
      period_s_(1.0 / rate_hz),
      max_bytes_(max_bytes),
      last_run_(run),
      writer_(path.string()) {
  for (std::size_t i = 0; i < kRunTopics.size(); ++i)
    writer_.AddChannel(std::string(kRunTopics[i]), RunSchema(static_cast<RunTopic>(i)));
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

/// What cannot be kept until it is written would be missing in the file, which ends therefore.
void Recorder::Push(Item item) {
  {
    const std::lock_guard lock(mutex_);
    try {
      items_.push_back(std::move(item));
    } catch (const std::bad_alloc&) {
      numbers_.failure = "no memory";
    }
  }
  wake_.notify_one();
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
  bool ended = false;  // the file takes no more
  for (bool more = true; more;) {
    std::deque<Item> items;
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, kFlushInterval, [this] { return finishing_ || !items_.empty(); });
      items.swap(items_);
      waiting_samples_ = 0;
      more = !finishing_ || !items.empty();
    }
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
    return Put(RunTopic::kCommands, entry->run, entry->entry.tick,
               EntryText(entry->entry, segment.config, segment.number, segment.commands++));
  }
  if (const auto* event = std::get_if<PublishedEvent>(&item)) {
    const auto segment = segments_.find(event->run);
    if (segment == segments_.end()) return;  // of a run before this file
    const SessionConfig& config = segment->second.config;
    return Put(RunTopic::kEvents, event->run, event->event.tick,
               RunEvent(event->event, config.model.hand, config.world.dt, segment->second.number));
  }
  const Sample& sample = std::get<Sample>(item);
  const Frame& frame = sample.published->frame;
  const std::uint64_t run = sample.published->run;
  const auto segment = segments_.find(run);
  if (segment == segments_.end()) return;
  const auto put = [&](RunTopic topic) {
    Put(topic, run, frame.tick, RunSample(topic, *sample.published, segment->second.number));
  };
  put(RunTopic::kState);
  if (!sample.all) return;
  for (const RunTopic topic : {RunTopic::kJoints, RunTopic::kContacts, RunTopic::kForces,
                               RunTopic::kObject, RunTopic::kQuality})
    put(topic);
  if (frame.gait.active) put(RunTopic::kGait);
}

void Recorder::WriteStart(const Start& start) {
  Segment& segment = segments_[start.run];
  segment.number = static_cast<int>(segments_.size()) - 1;
  segment.offset_ns = segment.number == 0 ? 0 : last_time_;
  segment.config = start.journal.config;
  Put(RunTopic::kRun, start.run, 0, ConfigText(segment.config, segment.number));
  for (const JournalEntry& entry : start.journal.entries)
    Put(RunTopic::kCommands, start.run, entry.tick,
        EntryText(entry, segment.config, segment.number, segment.commands++));
}

void Recorder::Put(RunTopic topic, std::uint64_t run, std::int64_t tick, std::string_view text) {
  const Segment& segment = segments_.at(run);
  const double time_ns = std::round(static_cast<double>(tick) * segment.config.world.dt * 1e9);
  const std::uint64_t time = segment.offset_ns + static_cast<std::uint64_t>(time_ns);
  last_time_ = std::max(last_time_, time);
  writer_.Write(static_cast<std::uint16_t>(static_cast<int>(topic) + 1), time, text);
}

}  // namespace regrasp
