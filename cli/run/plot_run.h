#pragma once

/// Pictures of run files, made by executing them again.

#include <string>
#include <vector>

#include "core/mcap/mcap_reader.h"
#include "snapshots/snapshots.h"

namespace regrasp::run {

struct PlotResult {
  std::vector<std::string> notes;  ///< see RunWindow; what is missing of a file
  std::vector<McapLoss> lost;      ///< of the stretches that are shown
  bool complete = true;            ///< every file has its end
};

/// Draws `name`, any picture but that of an incident, of the last segment into `out`, which
/// is replaced: its last job, or the newest `options.last_s` seconds where that is more than 0. A
/// comparison shows the last exploration of each file, of one file its last two. Throws
/// cli::CliError where the run has no such picture, no job or exploration, nothing to draw;
/// std::runtime_error: a replay that differs from its recording, what else pictures throw.
PlotResult PlotRuns(const std::vector<std::string>& paths, const std::string& name,
                    PlotOptions options, const std::string& out);

}  // namespace regrasp::run
