#pragma once

/// The state at tick 0: where the hand and the object of a run begin. A function of the
/// configuration and its seed.

#include "core/common/frames.h"
#include "core/common/limits.h"

namespace regrasp {

struct SessionConfig;

struct StartPosture {
  JointVector q_open;                        ///< generic preshape, with the seed's spread [rad]
  JointVector q_closed;                      ///< towards which `grasp` closes [rad]
  Isometry3d X_WO = Isometry3d::Identity();  ///< of the object
};

StartPosture MakeStart(const SessionConfig& config);

}  // namespace regrasp
