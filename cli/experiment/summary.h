#pragma once

/// What an experiment found, made from its rows: the same bytes whatever ran them, in whatever
/// order.

#include "cli/client/context.h"
#include "cli/experiment/store.h"

namespace regrasp::cli {

/// RFC 4180, a line for each row in the order of the plan.
std::string TrialsCsv(const Trials& trials);

/// The same of the maps of phi, a line for each sample; empty without maps.
std::string MapsCsv(const Trials& trials);

/// {"experiment": the plan, "trials": n, "groups": [{"noise", "estimator", "finger" | "axis_W",
/// "n", "counts": {NAME: {"k", "share", "low", "high"}}, "quantiles": {COLUMN: {"n", "min", "q05",
/// "q25", "median", "q75", "q95", "max", "mean", "sd", "median_low", "median_high"; below five
/// trials "values"}}}],
/// "comparisons": see Comparisons(), where there is anything to compare}. Shares are of all n
/// trials, also of those that were not grasped or refused, with Wilson's 95 % interval.
/// Explorations with several fingers also have a group "all" for each noise and estimator.
Json Summary(const Plan& plan, const Trials& trials);

/// Writes trials.csv, maps.csv (with maps only), summary.json and summary.png into `directory`.
/// Returns the summary. Throws CliError.
Json WriteResults(const Plan& plan, const Trials& trials, const std::filesystem::path& directory);

/// summary.pdf beside summary.json, of this printed width with text of at least 7 pt. Returns its
/// path. Throws CliError.
std::filesystem::path DrawForPaper(const std::filesystem::path& directory, double width_mm);

}  // namespace regrasp::cli
