#include "cli/run/replay_run.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/journal/journal_text.h"

namespace regrasp::run {

ReplayResult ReplayRun(const RunFile& file, const OnState& on_state) {
  ReplayResult result;
  for (std::size_t s = 0; s < file.segments.size() && !result.divergence; ++s) {
    const Segment& segment = file.segments[s];
    Replay replay(segment.journal);
    for (const Segment::State& state : segment.states) {
      if (!replay.RunTo(state.tick) || !replay.ApplyDue(state.commands) ||
          !replay.Compare(state.hash))
        break;
      if (on_state) on_state(static_cast<int>(s), replay.session());
    }
    if (!replay.diverged() && replay.RunTo(segment.last_tick())) replay.ApplyDue();
    result.segment = static_cast<int>(s);
    result.ticks += replay.session().tick();
    result.compared += replay.compared();
    result.commands += segment.journal->entries.size();
    if (replay.diverged()) result.divergence = replay.divergence();
  }
  return result;
}

std::string Verdict(const RunFile& file, const ReplayResult& result) {
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
