#pragma once

/// Statistics of pairs: the same seed under two settings. Every function is deterministic.

#include <optional>
#include <vector>

#include "cli/experiment/statistics.h"

namespace regrasp::cli {

/// Exact two-sided McNemar test [McNemar 1947]: whether two settings succeed equally often.
/// `gained` and `lost`: pairs in which only the second, only the first succeeded; pairs that agree
/// say nothing. The p-value of `lost` under a binomial distribution with probability 1/2; 1 without
/// discordant pairs.
double McNemarP(int gained, int lost);

/// Two-sided Wilcoxon signed-rank test [Wilcoxon 1945]: whether `differences` are symmetric about
/// 0. Differences of 0 are left out, tied ones share the mean of their ranks. With at most 100
/// differences exact: the distribution over all signs of these very ranks, ties included; with more
/// the normal approximation with corrections for ties and continuity. 1 when no difference is left.
double WilcoxonP(const std::vector<double>& differences);

/// 95 % percentile bootstrap interval of the mean [Efron 1979]: of 10 000 resamples, drawn from the
/// same stream of random numbers at every call. None below kLeastForInterval values.
std::optional<Interval> BootstrapInterval(const std::vector<double>& values);

/// Holm's step-down adjustment [Holm 1979]: p-values that may be compared with the level of the
/// whole family, in the order of `p`.
std::vector<double> HolmAdjusted(const std::vector<double>& p);

/// The least n with which Wilson's 95 % interval of a probability near `share` is no wider than
/// +-`precision`, 0 < precision < 0.5.
int TrialsForShare(double share, double precision);
/// The least n with which the normal 95 % interval of a mean is no wider than +-`precision` > 0,
/// for values with standard deviation `deviation`; at least kLeastForInterval. None for 0: values
/// that are all the same do not tell how much others would differ.
std::optional<int> TrialsForMean(double deviation, double precision);

/// The same of the difference of two shares, for pairs whose differences (-1, 0, 1) have standard
/// deviation `deviation`. For 0: with which Wilson's interval of the share of pairs that differ
/// from those seen ends at `precision`.
int TrialsForDifference(double deviation, double precision);

/// Standard deviation with n - 1; 0 for fewer than two values.
double StandardDeviation(const std::vector<double>& values);

}  // namespace regrasp::cli
