#pragma once

/// Statistics of an experiment's summary.

#include <cstddef>
#include <optional>
#include <vector>

namespace regrasp::cli {

struct Interval {
  double low = 0, high = 1;
};

/// Below so many values no 95 % interval of a median or mean is told: order statistics have none,
/// and resamples of so few repeat them.
inline constexpr std::size_t kLeastForInterval = 6;

/// Wilson's score interval for a probability, 95 % [Wilson 1927]: `successes` of `trials`, 0 <=
/// successes <= trials. It stays inside [0, 1] and is of use at 0 and at all successes, where the
/// normal approximation has width 0. No trials: [0, 1].
Interval WilsonInterval(int successes, int trials);

/// The `share` quantile of `values`, 0 <= share <= 1, linear between the order statistics (R's type
/// 7). `values`: at least one, ascending.
double Quantile(const std::vector<double>& values, double share);

/// 95 % interval of the median from order statistics, which holds for any continuous distribution:
/// the narrowest pair of the same rank from both ends that covers the median with at least 95 %.
/// None below six values, where no pair does. `values`: ascending.
std::optional<Interval> MedianInterval(const std::vector<double>& values);

}  // namespace regrasp::cli
