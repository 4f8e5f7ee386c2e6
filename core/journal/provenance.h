#pragma once

/// What a run was made with, against what this program has.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/journal/journal.h"

namespace regrasp {

/// What differs, a sentence each: the build, the model of hand or object (against the one of that
/// name in `search_path`), the parameters (against the defaults). Empty: nothing does. Whoever
/// restores, replays or exports a run is told before anything else.
std::vector<std::string> Differences(const SessionConfig& config, std::string_view build,
                                     const std::vector<std::filesystem::path>& search_path);

/// The same but for the models, which cost reading files: the build and the parameters.
std::vector<std::string> BuildAndParameterDifferences(const SessionConfig& config,
                                                      std::string_view build);

/// The parameters that differ from the model's defaults, with the default: "gait.speed 0.3 (0.2)",
/// separated by commas; empty: none does.
std::string ChangedText(const Parameters& parameters, const LoadedScenario& model);

}  // namespace regrasp
