#include "cli/experiment/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace regrasp::cli {

Interval WilsonInterval(int successes, int trials) {
  if (trials == 0) return {};
  constexpr double z = 1.959963984540054;  // standard normal, 97.5 %
  const double n = trials, p = successes / n;
  const double middle = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {successes == 0 ? 0.0 : std::max(0.0, middle - half),
          successes == trials ? 1.0 : std::min(1.0, middle + half)};
}

double Quantile(const std::vector<double>& values, double share) {
  assert(!values.empty());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

std::optional<Interval> MedianInterval(const std::vector<double>& values) {
  const std::size_t n = values.size();
  // P(at most k of n values lie below the median), each with probability 1/2, must not exceed 2.5
  // %.
  double probability = std::pow(0.5, static_cast<double>(n)), tail = probability;
  std::size_t rank = 0;  // values outside the interval at either end
  while (tail <= 0.025 && rank < n / 2) {
    ++rank;
    probability *= static_cast<double>(n - rank + 1) / static_cast<double>(rank);
    tail += probability;
  }
  if (rank == 0) return std::nullopt;
  return Interval{values[rank - 1], values[n - rank]};
}

}  // namespace regrasp::cli
