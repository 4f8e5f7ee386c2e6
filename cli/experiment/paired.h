#pragma once

/// Statistics of pairs: the same seed under two settings. Every function is deterministic.

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
/// same stream of random numbers at every call. One value: that value, twice.
/// `values`: at least one.
Interval BootstrapInterval(const std::vector<double>& values);

/// Holm's step-down adjustment [Holm 1979]: p-values that may be compared with the level of the
/// whole family, in the order of `p`.
std::vector<double> HolmAdjusted(const std::vector<double>& p);

/// The least n with which Wilson's 95 % interval of a probability near `share` is no wider than
/// +-`precision`, 0 < precision < 0.5.
int TrialsForShare(double share, double precision);
/// The least n with which the normal 95 % interval of a mean is no wider than +-`precision` > 0,
/// for values with standard deviation `deviation`; at least 2.
int TrialsForMean(double deviation, double precision);

/// Standard deviation with n - 1; 0 for fewer than two values.
double StandardDeviation(const std::vector<double>& values);

}  // namespace regrasp::cli
