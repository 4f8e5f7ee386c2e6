#pragma once

#include <array>
#include <cstdio>

#include "core/hand/hand_model.h"

namespace regrasp {

/// Why a finger stays: "thumb may not leave: the load margin without it is 0.123 N, below 0.250 N".
/// Ends with 0. `margin`: of the grasp without it, `below`: that is needed [N].
inline std::array<char, 160> MayNotLeave(const HandModel& hand, int finger, double margin,
                                         double below, int digits = 3) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "%s may not leave: the load margin without it is %.*f N, below %.*f N",
                hand.fingers[static_cast<std::size_t>(finger)].name.c_str(), digits, margin, digits,
                below);
  return text;
}

}  // namespace regrasp
