#pragma once

/// The state at tick 0: where the hand and the object of a run begin. A function of the models, the
/// spread and the seed.

#include <cstdint>

#include "core/common/frames.h"
#include "core/common/limits.h"

namespace regrasp {

struct HandModel;
struct Scenario;
struct StartParameters;

struct StartPosture {
  JointVector q_open;                         ///< generic preshape, with the seed's spread [rad]
  JointVector q_closed;                       ///< towards which `grasp` closes [rad]
  Isometry3d X_WO = Isometry3d::Identity();   ///< of the object
  Vector3d p_WO_expected = Vector3d::Zero();  ///< where q_closed is made for it to be [m]
};

StartPosture MakeStart(const HandModel& hand, const Scenario& scenario,
                       const StartParameters& spread, std::uint64_t seed);

}  // namespace regrasp
