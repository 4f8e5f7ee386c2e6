#include "core/gait/hop.h"

#include <gtest/gtest.h>

#include "core/exploration/exploration_parameters.h"
#include "core/gait/gait_parameters.h"
#include "core/shape/felt_surface.h"
#include "tests/unit/control/held_sphere.h"

namespace regrasp {
namespace {

struct HopTest : testing::Test {
  LoadedScenario model = ShadowHand();
  const HandModel& hand = model.hand;
  Estimate estimate = TouchingEstimate(hand, GraspPosture(hand));
  FeltSurface felt;
  LoadMargins margins;
  Vector3d gravity_W = model.scenario.gravity_W;
  ControlParameters control;
  ExplorationParameters exploration;
  GaitParameters gait;
  const int finger = hand.FindFinger("ring");
  const FingerEstimate stands = estimate.fingers[finger];
  Hop hop;
  Hop::Target target;

  /// Off to a place 15 degrees around the ball.
  HopTest() {
    const Quaterniond aside = FromRotationVector({0, 0, 0.26});
    target.p_WO = estimate.p_WO;
    target.p_WF = estimate.p_WO + aside * (stands.p_WF - estimate.p_WO);
    target.normal_W = aside * stands.normal_W;
    hop.Start(Tick(), finger, true);
  }
  ControlTick Tick() {
    return {hand,    estimate,    FingerSet::First(hand.num_fingers()),
            margins, felt,        gravity_W,
            control, exploration, gait,
            1e-3};
  }
  /// One tick, in which the finger touches or does not.
  Hop::Phase Step(bool touches) {
    FingerEstimate& f = estimate.fingers[finger];
    f.in_contact = touches;
    f.ticks_in_contact = touches ? f.ticks_in_contact + 1 : 0;
    FingerTask task;
    hop.Update(Tick(), target, false, &task);
    EXPECT_EQ(task.mode, FingerMode::kReach);
    return hop.phase();
  }
};

TEST_F(HopTest, StandsWhereItTouchesOnItsWay) {
  for (int k = 0; k < 1000 && hop.phase() != Hop::Phase::kAcross; ++k) Step(false);
  for (int k = 0; k < 20; ++k) ASSERT_EQ(Step(false), Hop::Phase::kAcross);
  for (int k = 0; k < 10 && hop.active(); ++k) Step(true);
  EXPECT_EQ(hop.phase(), Hop::Phase::kBlocked);
}

// One that a joint limit keeps on the surface has met no obstacle there: it goes on.
TEST_F(HopTest, GoesOnWhereItNeverCameOff) {
  for (int k = 0; k < 1000 && hop.phase() != Hop::Phase::kAcross; ++k) Step(true);
  ASSERT_EQ(hop.phase(), Hop::Phase::kAcross);
  for (int k = 0; k < 30; ++k) ASSERT_EQ(Step(true), Hop::Phase::kAcross);
  EXPECT_EQ(Step(false), Hop::Phase::kAcross);
  for (int k = 0; k < 10 && hop.active(); ++k) Step(true);
  EXPECT_EQ(hop.phase(), Hop::Phase::kBlocked);
}

}  // namespace
}  // namespace regrasp
