#include "cli/experiment/paired.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/common/random.h"

namespace regrasp::cli {
namespace {

constexpr double kZ = 1.959963984540054;  // standard normal, 97.5 %
constexpr std::size_t kMostExact = 100;   // differences
constexpr int kResamples = 10000;
constexpr std::uint64_t kBootstrapSeed = 1979, kBootstrapStream = 1;

/// Twice the rank of each value's size, ties sharing their mean, so that it is an integer.
std::vector<int> DoubledRanks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  const auto size = [&](std::size_t i) { return std::abs(values[i]); };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return size(a) < size(b); });
  std::vector<int> ranks(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && size(order[end]) == size(order[begin])) ++end;
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = static_cast<int>(begin + 1 + end);
  }
  return ranks;
}

/// P(sum of the ranks with a positive sign <= `sum`) when every sign is a fair coin.
double ExactTail(const std::vector<int>& ranks, int sum) {
  const int total = std::accumulate(ranks.begin(), ranks.end(), 0);
  std::vector<double> probability(static_cast<std::size_t>(total) + 1, 0.0);
  probability[0] = 1;
  int reached = 0;
  for (const int rank : ranks) {
    reached += rank;
    for (int s = reached; s >= 0; --s)
      probability[static_cast<std::size_t>(s)] =
          (probability[static_cast<std::size_t>(s)] +
           (s >= rank ? probability[static_cast<std::size_t>(s - rank)] : 0.0)) /
          2;
  }
  return std::accumulate(probability.begin(), probability.begin() + sum + 1, 0.0);
}

}  // namespace

double McNemarP(int gained, int lost) {
  const int n = gained + lost;
  double tail = 0;
  for (int k = 0; k <= std::min(gained, lost); ++k)
    tail += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) -
                     n * std::log(2.0));
  return std::min(1.0, 2 * tail);
}

double WilcoxonP(const std::vector<double>& differences) {
  std::vector<double> values;
  std::copy_if(differences.begin(), differences.end(), std::back_inserter(values),
               [](double d) { return d != 0; });
  if (values.empty()) return 1;
  const std::vector<int> ranks = DoubledRanks(values);
  int positive = 0, total = 0;
  double squares = 0;  // of the ranks
  for (std::size_t i = 0; i < values.size(); ++i) {
    total += ranks[i];
    squares += ranks[i] * 0.25 * ranks[i];
    if (values[i] > 0) positive += ranks[i];
  }
  const int less = std::min(positive, total - positive);
  if (values.size() <= kMostExact) return std::min(1.0, 2 * ExactTail(ranks, less));
  const double off = total / 4.0 - less / 2.0;  // of the sum of ranks from its mean
  return std::min(1.0, std::erfc(std::max(0.0, off - 0.5) / std::sqrt(squares / 4) / std::sqrt(2)));
}

std::optional<Interval> BootstrapInterval(const std::vector<double>& values) {
  if (values.size() < kLeastForInterval) return std::nullopt;
  RandomStream random(kBootstrapSeed, kBootstrapStream);
  const std::size_t n = values.size();
  std::vector<double> means(kResamples);
  for (double& mean : means) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i)
      sum += values[static_cast<std::size_t>(random.Uniform() * static_cast<double>(n))];
    mean = sum / static_cast<double>(n);
  }
  std::sort(means.begin(), means.end());
  return Interval{Quantile(means, 0.025), Quantile(means, 0.975)};
}

std::vector<double> HolmAdjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, static_cast<double>(p.size() - i) * p[order[i]]);
    adjusted[order[i]] = std::min(1.0, largest);
  }
  return adjusted;
}

int TrialsForShare(double share, double precision) {
  assert(precision > 0 && precision < 0.5);
  const auto half_width = [&](double n) {
    return kZ / (1 + kZ * kZ / n) * std::sqrt(share * (1 - share) / n + kZ * kZ / (4 * n * n));
  };
  int n = 1;
  while (half_width(n) > precision) ++n;
  return n;
}

std::optional<int> TrialsForMean(double deviation, double precision) {
  assert(precision > 0);
  if (deviation == 0) return std::nullopt;
  const double root = kZ * deviation / precision;
  return std::max(static_cast<int>(kLeastForInterval),
                  static_cast<int>(std::min(1e9, std::ceil(root * root))));
}

int TrialsForDifference(double deviation, double precision) {
  const std::optional<int> n = TrialsForMean(deviation, precision);
  return n ? *n : TrialsForShare(0, precision / 2);  // from 0 it reaches to twice its half width
}

double StandardDeviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0;
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / (n - 1));
}

}  // namespace regrasp::cli
