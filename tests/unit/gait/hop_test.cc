#include "core/gait/hop.h"

#include <gtest/gtest.h>

#include "tests/unit/gait/held_tick.h"

namespace regrasp {
namespace {

struct HopTest : HeldTick {
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
