#pragma once

/// What the strip below a gait's curves shows. Internal to snapshots/.

#include "core/session/frame.h"

namespace regrasp {

inline constexpr int kTurning = 100;

/// The finger that regrasps, kTurning while the object is turned, -1 without a gait.
inline int GaitStateOf(const Frame& frame) {
  if (!frame.gait.active) return -1;
  return frame.gait.finger >= 0 ? frame.gait.finger : kTurning;
}

}  // namespace regrasp
