#pragma once

/// Ranges of options that no row of the wire has.

namespace regrasp {

/// Tilt of a hand, to either side: 0 palm up, 90 fingers down.
inline constexpr double kMostTilt_deg = 180;
/// Diameter of the ball that a scenario is made for.
inline constexpr double kLeastBall_mm = 20, kMostBall_mm = 150;

}  // namespace regrasp
