#pragma once

/// From a plan to results: what `experiment exploration|noise-sweep|rotation` and the parts of
/// `experiment paper` share.

#include <filesystem>

#include "cli/client/context.h"
#include "cli/experiment/plan.h"

namespace regrasp::cli {

/// Fills in what only a daemon knows: the fingers' names for "all", version and build, and what
/// decides the results of every case. Throws
/// CliError when it does not take the plan's parameters or has no such finger.
void CompletePlan(Plan* plan);

/// Runs what is left of `plan` in `directory`, writes trials.csv, summary.json and summary.png
/// there, and returns the summary. Throws CliError; after an interruption the text says how many
/// are kept.
Json RunExperiment(Context& context, const Plan& plan, int workers,
                   const std::filesystem::path& directory);

/// --workers, or the number of cores.
int Workers(const Invocation& invocation);

}  // namespace regrasp::cli
