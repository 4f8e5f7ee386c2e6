#pragma once

/// Trials in several processes.

#include <functional>
#include <vector>

namespace regrasp::claims {

/// The numbers of a trial; empty where its process ended early.
using Row = std::vector<double>;

/// Runs `trial(k)` for k in [0, n) in `jobs` processes; rows come back in order.
std::vector<Row> Parallel(int n, int jobs, const std::function<Row(int)>& trial);

}  // namespace regrasp::claims
