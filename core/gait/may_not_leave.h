#pragma once

/// When a finger may leave, and what is said of one that may not.

#include <cstdio>

#include "core/common/reason.h"
#include "core/control/control_tick.h"
#include "core/hand/hand_model.h"

namespace regrasp {

/// The rule of both gaits: its tip can be put elsewhere, and the load margin of the grasp without
/// it is at least `needed` [N].
inline bool MayLeave(const ControlTick& tick, int finger, double needed) {
  return PlacesItsTip(tick.hand.fingers[finger]) && tick.margins.without[finger] >= needed;
}

/// A finger that has had its turn without leaving.
struct Refusal {
  int finger = -1;    ///< -1: none
  double margin = 0;  ///< of the grasp without it [N]
  double below = 0;   ///< that is needed [N]
  template <typename V>
  void Fields(V& v) {
    v("finger", finger, v.Finger());
    v("margin", margin, kUnbounded);
    v("below", below);
  }
};

/// Why a finger stays: "thumb may not leave: the load margin without it is 0.123 N, below 0.250 N".
/// Ends with 0. `margin`: of the grasp without it, `below`: that is needed [N].
inline ReasonText MayNotLeave(const HandModel& hand, int finger, double margin, double below,
                              int digits = 3) {
  ReasonText text{};
  std::snprintf(text.data(), text.size(),
                "%s may not leave: the load margin without it is %.*f N, below %.*f N",
                hand.fingers[static_cast<std::size_t>(finger)].name.c_str(), digits, margin, digits,
                below);
  return text;
}

}  // namespace regrasp
