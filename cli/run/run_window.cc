#include "cli/run/run_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "cli/client/errors.h"
#include "core/journal/check.h"
#include "core/journal/saved_state.h"

namespace regrasp::run {
namespace {

/// What comes after the saved state, from there. Throws StateError where the state is of another
/// build, was changed, or is not of the moment that it says.
std::unique_ptr<Replay> ReplayFrom(const Journal& journal, const RunSavedState& state) {
  const auto& entries = journal.entries;
  const std::size_t n = state.commands;
  const bool fits = n <= entries.size() && (n == 0 || entries[n - 1].tick <= state.tick) &&
                    (n == entries.size() || entries[n].tick >= state.tick);
  if (!fits) throw StateError("saved state: it does not fit the commands");
  auto rest = std::make_shared<Journal>();
  rest->config = journal.config;
  rest->entries.assign(entries.begin() + static_cast<std::ptrdiff_t>(n), entries.end());
  auto replay = std::make_unique<Replay>(std::move(rest));
  LoadState(state.bytes, &replay->session());
  if (replay->session().tick() != state.tick || replay->session().StateHash() != state.state_hash)
    throw StateError("saved state: of another moment than the file says");
  return replay;
}

}  // namespace

void RefuseBeginning(double from_s, double end_s) {
  throw cli::CliError(
      ExitCode::kUsage,
      fmt::format("nothing happens from --from {:g} s on: the run ends at {:g} s", from_s, end_s));
}

void AddLosses(const std::vector<McapLoss>& lost, std::vector<McapLoss>* all) {
  for (const McapLoss& loss : lost) {
    const auto same = [&](const McapLoss& other) {
      return other.offset == loss.offset && other.cause == loss.cause;
    };
    if (std::ranges::none_of(*all, same)) all->push_back(loss);
  }
  std::ranges::stable_sort(*all, {}, &McapLoss::offset);
}

std::uint64_t LastTime(const std::string& path, const std::vector<McapChunk>& chunks) {
  std::uint64_t end = 0;
  for (const McapChunk& chunk : chunks) end = std::max(end, chunk.end);
  if (chunks.empty()) ReadMcap(path, [&](const McapMessage& m) { end = std::max(end, m.time); });
  return end;
}

RunWindow::RunWindow(const std::string& path, Stretch stretch, double lead_s, int segment_number)
    : path_(path),
      stretch_(stretch),
      file_(ReadJournals(path, &chunks_)),
      number_(segment_number == kLast ? static_cast<int>(file_.segments.size()) - 1
                                      : segment_number) {
  FindEnd();
  if (last_tick_ < from_tick())
    RefuseBeginning(stretch.from_s,
                    static_cast<double>(last_tick_) * segment().journal->config.world.dt);
  if (stretch.to_s <= stretch.from_s)
    throw std::runtime_error("nothing happens in this stretch of time");
  stretch_.from_s = std::max(0.0, stretch.from_s - lead_s);
  try {
    if (const auto state = FindState()) {
      replay_ = ReplayFrom(*segment().journal, *state);
      start_tick_ = state->tick;
      commands_before_ = state->commands;
      from_saved_state_ = true;
    }
  } catch (const std::runtime_error& e) {
    note_ = std::string(e.what()) + "; executed from the start instead";
  }
  if (!replay_) replay_ = std::make_unique<Replay>(segment().journal);
}

std::int64_t RunWindow::TickOf(double time_s) const {
  return std::llround(std::min(time_s / segment().journal->config.world.dt, 1e15));
}

std::uint64_t RunWindow::FileTime(std::int64_t tick) const {
  return segment().offset_ns +
         static_cast<std::uint64_t>(
             std::llround(static_cast<double>(tick) * segment().journal->config.world.dt * 1e9));
}

void RunWindow::FindEnd() {
  const double dt_ns = segment().journal->config.world.dt * 1e9;
  const std::size_t next = static_cast<std::size_t>(number_) + 1;
  const std::uint64_t end =
      std::max(segment().offset_ns, next < file_.segments.size() ? file_.segments[next].offset_ns
                                                                 : LastTime(path_, chunks_));
  const double ticks = static_cast<double>(end - segment().offset_ns) / dt_ns;
  if (!(ticks <= static_cast<double>(kMaxTick)))
    throw std::runtime_error(
        fmt::format("{}: ends at tick {:.4g}; allowed are at most {}", path_, ticks, kMaxTick));
  last_tick_ = std::llround(ticks);
}

std::vector<McapLoss> RunWindow::Losses(std::int64_t end_tick) const {
  const std::uint64_t begin = FileTime(from_tick()), end = FileTime(end_tick);
  std::vector<McapLoss> lost;
  std::ranges::copy_if(file_.lost, std::back_inserter(lost),
                       [&](const McapLoss& loss) { return loss.end == 0 || loss.start <= end; });
  if (chunks_.empty()) return lost;  // no index: all has been read
  const auto here = [&](const McapChunk& chunk) {
    return chunk.end >= begin && chunk.start <= end;
  };
  AddLosses(ReadMcap(
                path_, [](const McapMessage&) {}, here)
                .lost,
            &lost);
  return lost;
}

std::optional<RunSavedState> RunWindow::FindState() const {
  const std::uint64_t time = FileTime(from_tick());
  std::uint64_t wanted = 0;
  for (const McapChunk& chunk : chunks_)
    if (chunk.topics.contains("saved_states") && chunk.start <= time) wanted = chunk.offset;
  std::optional<RunSavedState> found;
  const auto take = [&](const McapMessage& message) {
    if (message.topic != "saved_states" || message.time > time) return;
    RunSavedState state = ParseSavedState(message.data);
    const bool here = state.segment == number_;
    if (here && (!found || state.tick >= found->tick)) found = std::move(state);
  };
  ReadMcap(path_, take, [&](const McapChunk& chunk) { return chunk.offset == wanted; });
  return found;
}

ReplayResult RunWindow::ReplayStretch(const OnState& on_state) {
  const std::int64_t from = from_tick(), end = end_tick();
  const auto compare = [&](const McapMessage& message) {
    if (message.topic != "state" || replay_->diverged()) return;
    int of = 0;
    const Segment::State state = ParseState(message.data, &of);
    if (of != number_ || state.tick < std::max(from, replay_->session().tick()) || state.tick > end)
      return;
    if (state.commands < commands_before_) return;  // at the saved state's tick, but before it
    if (replay_->RunTo(state.tick) && replay_->ApplyDue(state.commands - commands_before_) &&
        replay_->Compare(state.hash) && on_state)
      on_state(number_, replay_->session());
  };
  ReplayResult result;
  result.segment = number_;
  if (replay_->RunTo(from)) {
    ReadMcap(path_, compare, [&](const McapChunk& chunk) {  // what is lost has been found
      return !replay_->diverged() && chunk.topics.contains("state") &&
             chunk.end >= FileTime(from) && chunk.start <= FileTime(end);
    });
    if (!replay_->diverged() && replay_->RunTo(end) && to_the_end()) replay_->ApplyDue();
  }
  result.ticks = replay_->session().tick() - start_tick_;
  result.compared = replay_->compared();
  result.commands = static_cast<std::size_t>(std::ranges::count_if(
      segment().journal->entries,
      [&](const JournalEntry& entry) { return entry.tick >= start_tick_ && entry.tick <= end; }));
  if (replay_->diverged()) {
    result.divergence = replay_->divergence();
    if (result.divergence->command >= 0)
      result.divergence->command += static_cast<int>(commands_before_);
  }
  return result;
}

}  // namespace regrasp::run
