#pragma once

/// Re-executes a run file and compares every recorded state.

#include <functional>
#include <optional>

#include "cli/run/run_file.h"
#include "core/journal/replay.h"

namespace regrasp::run {

struct ReplayResult {
  std::int64_t ticks = 0;     ///< executed, of all segments
  std::int64_t compared = 0;  ///< state hashes
  std::size_t commands = 0;
  int segment = 0;  ///< in which it differs
  std::optional<Divergence> divergence;
  std::optional<std::int64_t> false_state;  ///< tick of a saved state that is not the one here
  bool identical() const { return !divergence && !false_state; }
};

/// Called after the recorded state at its tick has been compared.
using OnState = std::function<void(int segment, Session& session)>;

/// Runs until the first difference, or to the end. Saved states of this build are compared byte by
/// byte with those that the commands lead to. `on_state` may be empty.
ReplayResult ReplayRun(const RunFile& file, const OnState& on_state);

/// "differs at tick 1200, at command 3 (param.set); equal until tick 1190", or "identical".
std::string Verdict(const RunFile& file, const ReplayResult& result);

}  // namespace regrasp::run
