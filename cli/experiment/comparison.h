#pragma once

/// Settings against each other on the same seeds: differences with intervals and p-values.

#include "cli/experiment/store.h"

namespace regrasp::cli {

/// A column of trials.csv that settings are compared by.
struct Measure {
  const char* column;
  const char* title;  ///< "deg/min"
  double scale;       ///< to the unit of the title
  int digits;
  bool success;               ///< true or false; else a number
  bool of_criterion = false;  ///< in the unit of what is maximised
};

/// The measures of the plan's kind of experiment.
std::vector<Measure> MeasuresOf(const Plan& plan);

/// Every case against the one it is paired with (Case::against, or the first), and every estimator
/// against the first: a list of {"what": "case"|"estimator", "base", "other", "noise", "finger" |
/// "axis_W", ..., "pairs", "measures": {COLUMN: {"n", "base", "other", "difference", "low", "high",
/// "sd", "test", "p", "p_holm"}}, "left_out": columns that are not compared because the settings
/// maximise something else}. `base`, `other`, `difference`: means over the n pairs in which
/// both are known (of successes: all pairs), [low, high] the bootstrap interval of the difference
/// (null below kLeastForInterval pairs), `sd` of the differences. Successes have "gained" and
/// "lost" pairs and McNemar's p, all else Wilcoxon's signed rank. p_holm: adjusted for all
/// comparisons of the same measure that are no sums of others ("finger": "all"; "case": "all", of
/// cases whose names end alike); those sums for each other.
Json Comparisons(const Plan& plan, const Trials& trials);

}  // namespace regrasp::cli
