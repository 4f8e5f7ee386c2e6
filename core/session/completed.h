#pragma once

#include <cmath>
#include <numbers>

namespace regrasp {

/// The object has turned by what was asked, and a rotation that has ended is done, when its true
/// angle is as near to it as this: what the controller believes to have reached does not count
/// [rad].
inline constexpr double kCompletedWithin = 5 * std::numbers::pi / 180;

/// Angles about the same axis, unwrapped and signed [rad]; false for NaN.
inline bool TurnedAsAsked(double true_angle, double asked) {
  return std::abs(true_angle - asked) <= kCompletedWithin;
}

}  // namespace regrasp
