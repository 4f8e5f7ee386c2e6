#include "cli/run/replay_run.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/journal/journal_text.h"
#include "core/journal/saved_state.h"

namespace regrasp::run {

namespace {

/// Compares the saved states up to this moment; false at one that is another.
class SavedStates {
 public:
  explicit SavedStates(const Segment& segment)
      : segment_(segment), same_build_(segment.build == BuildIdentity()) {}
  bool CompareUpTo(std::int64_t tick, std::size_t commands, Replay* replay) {
    for (; next_ < segment_.saved.size(); ++next_) {
      const Segment::Saved& saved = segment_.saved[next_];
      if (std::pair(saved.tick, saved.commands) > std::pair(tick, commands)) return true;
      if (!same_build_) continue;
      if (!replay->RunTo(saved.tick) || !replay->ApplyDue(saved.commands)) return true;
      if (!replay->Compare(saved.hash)) return true;
      if (DigestOf(SaveState(replay->session())) == saved.digest) continue;
      false_state_ = saved.tick;
      return false;
    }
    return true;
  }
  const std::optional<std::int64_t>& false_state() const { return false_state_; }

 private:
  const Segment& segment_;
  const bool same_build_;
  std::size_t next_ = 0;
  std::optional<std::int64_t> false_state_;
};

}  // namespace

ReplayResult ReplayRun(const RunFile& file, const OnState& on_state) {
  ReplayResult result;
  for (std::size_t s = 0; s < file.segments.size() && result.identical(); ++s) {
    const Segment& segment = file.segments[s];
    Replay replay(segment.journal);
    SavedStates saved(segment);
    for (const Segment::State& state : segment.states) {
      if (!saved.CompareUpTo(state.tick, state.commands, &replay) || !replay.RunTo(state.tick) ||
          !replay.ApplyDue(state.commands) || !replay.Compare(state.hash))
        break;
      if (on_state) on_state(static_cast<int>(s), replay.session());
    }
    if (!replay.diverged() && !saved.false_state() &&
        saved.CompareUpTo(segment.last_tick(), SIZE_MAX, &replay) &&
        replay.RunTo(segment.last_tick()))
      replay.ApplyDue();
    result.segment = static_cast<int>(s);
    result.ticks += replay.session().tick();
    result.compared += replay.compared();
    result.commands += segment.journal->entries.size();
    if (replay.diverged()) result.divergence = replay.divergence();
    result.false_state = saved.false_state();
  }
  return result;
}

std::string Verdict(const RunFile& file, const ReplayResult& result) {
  if (result.false_state)
    return fmt::format("the saved state at tick {} is not the one that the commands lead to",
                       *result.false_state);
  if (!result.divergence) return "identical";
  const Divergence& d = *result.divergence;
  const Segment& segment = file.segments[static_cast<std::size_t>(result.segment)];
  std::string text = fmt::format("differs at tick {}", d.tick);
  if (file.segments.size() > 1) text += fmt::format(" of segment {}", result.segment);
  if (d.command >= 0) {
    const auto entry = nlohmann::json::parse(
        EntryText(segment.journal->entries[static_cast<std::size_t>(d.command)],
                  segment.journal->config, result.segment, static_cast<std::size_t>(d.command)));
    text += fmt::format(", at command {} ({})", d.command, entry.at("method").get<std::string>());
  }
  text += d.last_equal >= 0 ? fmt::format("; equal until tick {}", d.last_equal)
                            : std::string("; nothing before it is equal");
  return text;
}

}  // namespace regrasp::run
