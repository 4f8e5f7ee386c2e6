#pragma once

/// A tick of a hand whose fingertips all touch a sphere, for what the gait decides in one.

#include <gtest/gtest.h>

#include "core/control/control_tick.h"
#include "core/exploration/exploration_parameters.h"
#include "core/gait/gait_parameters.h"
#include "core/shape/felt_surface.h"
#include "tests/unit/control/held_sphere.h"

namespace regrasp {

struct HeldTick : testing::Test {
  LoadedScenario model = ShadowHand();
  const HandModel& hand = model.hand;
  FingerSet all = FingerSet::First(hand.num_fingers());
  Estimate estimate = TouchingEstimate(hand, GraspPosture(hand));
  FeltSurface felt;
  LoadMargins margins;
  Vector3d gravity_W = model.scenario.gravity_W;
  ControlParameters control;
  ExplorationParameters exploration;
  GaitParameters gait;

  ControlTick Tick() const {
    return {hand, estimate, all, margins, felt, gravity_W, control, exploration, gait, 1e-3};
  }
};

}  // namespace regrasp
