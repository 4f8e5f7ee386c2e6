#pragma once

/// Which measure of a running gait foretells that it fails? Looks at the gait become windows, each
/// with predictors and whether a failure follows; ROC curves say how well each predictor tells.
///
/// A failure: the object is dropped, or a regrasp is broken off because the object has left its
/// reference (a slip). Of a look at time t
///   left out  where a failure lies in [t − kAfter_s, t + kSoon_s]: the gait recovers, or it is too
///             late; where the run has no kHistory_s before t; and where it ends before t + kFar_s
///             without a failure;
///   fails     where one lies in (t + kSoon_s, t + kFar_s];
///   does not  otherwise.

#include <string>
#include <vector>

#include "cli/client/client.h"
#include "cli/experiment/plan.h"
#include "cli/experiment/store.h"

namespace regrasp::cli {

inline constexpr double kSoon_s = 0.2, kFar_s = 1.0, kAfter_s = 1.0, kHistory_s = 0.5;

/// A quantity of the controller that is looked at, in the order in which looks hold their values.
struct WatchedMeasure {
  const char *name, *title;
  int danger;             ///< -1: a low value is bad, +1: a high one
  bool of_grasp = false;  ///< of the whole grasp: stands in `quality` by its name; these come first
};
const std::vector<WatchedMeasure>& WatchedMeasures();

/// One run of a gait as it was looked at.
struct WatchedRun {
  std::vector<double> time_s;               ///< of the looks, ascending
  std::vector<std::vector<double>> values;  ///< per look, a value per measure
  std::vector<double> failures_s;           ///< ascending
  double end_s = 0;                         ///< of the run
};

enum class Label { kLeftOut, kFails, kHolds };
std::vector<Label> LabelsOf(const WatchedRun& run);

/// Out of the looks of the last kHistory_s up to look `i`: the value now, the worst, and the trend
/// (least squares slope per second).
enum class Form { kNow, kWorst, kTrend };
/// Larger is more dangerous.
double Score(const WatchedRun& run, std::size_t i, std::size_t measure, Form form);

/// Looks at the gait once, by what the controller knows: a value for each measure.
std::vector<double> Look(const Json& quality, const Json& contacts);

/// A run as a unit keeps it, and back.
Json ToJson(const WatchedRun& run);
WatchedRun WatchedRunFromJson(const Json& json);

/// {"runs", "looks", "failures", "windows_failing", "windows_holding", "predictors": [{"measure",
/// "form", "auc", "low", "high", "behind", "behind_low", "behind_high", "foretold",
/// "failures_foretold", "roc": [[false alarms, foretold]]}]}, best first. Intervals by bootstrap
/// over runs, null below kLeastForInterval of them; `behind`: the best predictor's area minus this
/// one's.
Json PredictionSummary(const Trials& trials);

}  // namespace regrasp::cli
