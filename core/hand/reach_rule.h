#pragma once

namespace regrasp {

/// How a finger is taken to follow an object (finger_reach.h); gait.middle_pull and
/// gait.follow_tolerance.
struct ReachRule {
  double middle_pull = 0.15;  ///< of the way to the middle of a joint's range, in the null space
  double tolerance = 0.002;   ///< a finger this far behind no longer follows [m]
};

}  // namespace regrasp
