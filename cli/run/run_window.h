#pragma once

/// A stretch of a segment of a run file, of the last one as a rule: from the nearest saved state
/// before it, so that it begins at once however long the run was.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/run/replay_run.h"
#include "core/journal/run_messages.h"

namespace regrasp::run {

/// Simulated time [s] of the segment.
struct Stretch {
  double from_s = 0, to_s = 1e9;
};

/// Refuses a stretch that begins where the run, which ends at `end_s`, is over: CliError(kUsage).
[[noreturn]] void RefuseBeginning(double from_s, double end_s);
/// The time of the last message [ns]. `chunks`: of the file, none where it has no index.
std::uint64_t LastTime(const std::string& path, const std::vector<McapChunk>& chunks);

/// Adds those that are not there yet; in the order of the file.
void AddLosses(const std::vector<McapLoss>& lost, std::vector<McapLoss>* all);

class RunWindow {
 public:
  /// Reads the journal and begins at the last saved state that is not after `from_s`; at tick 0
  /// where there is none, or none that can be trusted: note() then says why. Throws McapError,
  /// JournalError, ModelError, CliError(kUsage) where the run ends before `from_s`. With `lead_s`
  /// the window begins so much earlier. `segment`: which one, or kLast.
  static constexpr int kLast = -1;
  RunWindow(const std::string& path, Stretch stretch, double lead_s = 0, int segment = kLast);

  /// Executes the stretch and compares every state in it that was recorded.
  ReplayResult ReplayStretch(const OnState& on_state);

  /// Its journals; lost: what could not be read of all of them.
  const RunFile& file() const { return file_; }
  /// What could not be read of the stretch, or of the journals before its end: whatever it holds,
  /// samples too, which nothing here needs. Reads the stretch. With a tick, the stretch ends there.
  std::vector<McapLoss> Losses() const { return Losses(end_tick()); }
  std::vector<McapLoss> Losses(std::int64_t end_tick) const;
  const Segment& segment() const { return file_.segments[static_cast<std::size_t>(number_)]; }
  int number() const { return number_; }  ///< of the segment in the file
  Replay& replay() { return *replay_; }
  /// Where it began, and whether that is a saved state.
  std::int64_t start_tick() const { return start_tick_; }
  bool from_saved_state() const { return from_saved_state_; }
  /// So many of the segment's commands are in that state.
  std::size_t commands_before() const { return commands_before_; }
  const std::string& note() const { return note_; }
  /// The stretch, no longer than the run [ticks].
  std::int64_t from_tick() const { return TickOf(stretch_.from_s); }
  std::int64_t end_tick() const { return std::min(TickOf(stretch_.to_s), last_tick_); }
  /// Whether the stretch goes on to the end of the segment.
  bool to_the_end() const { return end_tick() == last_tick_; }

 private:
  std::int64_t TickOf(double time_s) const;
  std::uint64_t FileTime(std::int64_t tick) const;
  /// The last saved state of the segment that is not after the stretch's beginning.
  std::optional<RunSavedState> FindState() const;
  void FindEnd();

  std::string path_;
  Stretch stretch_;
  std::vector<McapChunk> chunks_;
  RunFile file_;
  int number_ = 0;
  std::int64_t last_tick_ = 0;
  std::unique_ptr<Replay> replay_;
  std::int64_t start_tick_ = 0;
  bool from_saved_state_ = false;
  std::size_t commands_before_ = 0;
  std::string note_;
};

}  // namespace regrasp::run
