#pragma once

/// How the gradient of phi is estimated, as one table: the command line, the wire, parameters, run
/// files and saved states follow from it. A new estimator is an entry, a row, and what
/// SurfaceExploration::Add() and GradientOf() do for it (surface_exploration.cc).

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/common/info_table.h"

namespace regrasp {

/// In the order of the table. kSecant is the paper's printed line 6.
enum class Estimator : std::uint8_t { kSecant, kLeastSquares };
inline constexpr Estimator kDefaultEstimator = Estimator::kLeastSquares;

struct EstimatorInfo {
  Estimator id;
  std::string_view name;
  /// The finger circles while it explores, so that both tangent directions are seen; it needs no
  /// least speed then where the gradient has all but vanished.
  bool dithers;
  /// The best contact is kept: the finger returns to it, tries again where it gained little, and
  /// ends where it gains nothing. Without, Algorithm 1 runs as printed.
  bool keeps_best;
};

inline constexpr auto kEstimatorTable = std::to_array<EstimatorInfo>({
    {Estimator::kSecant, "secant", false, false},
    {Estimator::kLeastSquares, "least_squares", true, true},
});
inline constexpr auto kLastEstimator = static_cast<Estimator>(kEstimatorTable.size() - 1);
static_assert(InOrder(kEstimatorTable));

constexpr const EstimatorInfo& InfoOf(Estimator estimator) {
  return kEstimatorTable[static_cast<std::size_t>(estimator)];
}
constexpr std::string_view Name(Estimator estimator) { return InfoOf(estimator).name; }

inline constexpr auto kEstimatorNames = NamesOf<kEstimatorTable.size()>(kEstimatorTable);
/// The default first.
inline constexpr auto kOfferedEstimators = [] {
  auto names = kEstimatorNames;
  const auto first = names.begin() + static_cast<std::ptrdiff_t>(kDefaultEstimator);
  std::rotate(names.begin(), first, first + 1);
  return names;
}();

}  // namespace regrasp
