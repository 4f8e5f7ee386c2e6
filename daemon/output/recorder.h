#pragma once

/// Writes a run file beside the simulation: the I/O thread hands over what it has taken from the
/// control loop's rings, a thread of its own makes messages of it and writes them. Samples are
/// dropped, and counted, when the disk is too slow; the journal and events never.

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include "core/journal/run_messages.h"
#include "core/mcap/mcap_writer.h"
#include "daemon/loop/control_loop.h"

namespace regrasp {

class Recorder {
 public:
  static constexpr std::size_t kMaxWaiting = 2000;  ///< frames; some 15 MB

  /// Creates the file. `rate_hz`: samples per second of simulated time. `journal`: the present run
  /// up to now, number `run`. The file ends, whole, once it has `max_bytes`. Throws McapError.
  Recorder(const std::filesystem::path& path, double rate_hz, const Journal& journal,
           std::uint64_t run, std::uint64_t max_bytes);
  /// Finishes the file.
  ~Recorder();

  void Begin(const Journal& journal, std::uint64_t run);
  void Add(const JournalEntry& entry, std::uint64_t run);
  void Add(const Event& event, std::uint64_t run);
  void Add(const Published& published);
  /// A state to go on from: what the control loop answered to a mark.
  void Add(const JournalNews& mark);
  /// Waits until the journal as it was handed over is in the file, or the file has ended; 0.2 s at
  /// most, where the disk is slow: so long nobody is served.
  void AwaitJournal();
  /// Whether a state is due at this moment; asked again, the next one.
  bool TakeStateDue(const Published& published);
  /// Writes what is waiting and ends the file. Any thread, once.
  void Finish();

  struct Numbers {
    std::uint64_t messages = 0, bytes = 0, dropped = 0;
    std::string failure;  ///< why the file ended early; empty: it has not
    bool full = false;    ///< it has as many bytes as it may, and is complete
  };
  Numbers numbers() const;
  const std::filesystem::path& path() const { return path_; }

 private:
  struct Start {
    Journal journal;
    std::uint64_t run;
  };
  struct Entry {
    JournalEntry entry;
    std::uint64_t run;
  };
  struct Sample {
    std::unique_ptr<const Published> published;
    bool all;  ///< every topic, not only the state hash
  };
  struct State {
    std::int64_t tick;
    std::uint64_t state_hash, run;
    std::shared_ptr<const std::string> bytes;
  };
  using Item = std::variant<Start, Entry, PublishedEvent, Sample, State>;

  static bool IsJournal(const Item& item);
  void Push(Item item);
  void Run();
  void Write(const Item& item);
  void WriteStart(const Start& start);
  /// Where a message of this tick stands in the file.
  RunPlace Place(std::uint64_t run, std::int64_t tick) const;
  void Put(RunTopic topic, const RunPlace& place, std::string_view text);
  /// The same in a chunk of its own: what a replay needs first is found without reading the rest.
  void PutAlone(RunTopic topic, const RunPlace& place, std::string_view text);
  void WriteSample(const Sample& sample);

  const std::filesystem::path path_;
  const double period_s_;
  const std::uint64_t max_bytes_;
  // I/O thread.
  std::uint64_t last_run_ = 0;
  double dt_ = 1e-3;
  std::int64_t next_sample_ = 0, next_state_ = 0;  ///< ticks
  std::uint64_t state_run_ = 0;                    ///< whose next state it is
  // The recorder's thread.
  struct Segment {
    int number = 0;
    std::uint64_t offset_ns = 0;  ///< of its tick 0 in the file's time
    std::size_t commands = 0;
    SessionConfig config;
  };
  McapWriter writer_;
  std::map<std::uint64_t, Segment> segments_;  ///< by run
  std::uint64_t last_time_ = 0;
  // Shared.
  mutable std::mutex mutex_;
  std::condition_variable wake_, written_;
  std::deque<Item> items_;
  std::ptrdiff_t waiting_journal_ = 0;
  std::size_t waiting_samples_ = 0;
  bool finishing_ = false;
  Numbers numbers_;
  std::thread thread_;
};

}  // namespace regrasp
