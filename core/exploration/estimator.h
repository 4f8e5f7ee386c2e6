#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace regrasp {

/// How the gradient is estimated. kSecant is the paper's printed line 6; kLeastSquares is the
/// default.
enum class Estimator : std::uint8_t { kSecant, kLeastSquares };
inline constexpr std::array<std::string_view, 2> kEstimatorNames = {"secant", "least_squares"};
inline std::string_view Name(Estimator estimator) {
  return kEstimatorNames[static_cast<std::size_t>(estimator)];
}

}  // namespace regrasp
