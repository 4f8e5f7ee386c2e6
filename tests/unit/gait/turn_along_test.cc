#include "core/gait/turn_along.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/gait/sure_reserve.h"
#include "core/hand/finger_reach.h"
#include "tests/unit/gait/held_tick.h"

namespace regrasp {
namespace {

const Vector3d kAxis_W = -Vector3d::UnitZ();

struct TurnAlongTest : HeldTick {
  ObjectWrench wrench;
  TurnAlong along;

  TurnAlongTest() { wrench.Start(estimate, gravity_W, control); }

  /// The speed that it comes to [rad/s].
  double Settled(FingerSet holds, double margin, double most) {
    const ControlTick tick = Tick();
    double speed = 0;
    for (int k = 0; k < 1000; ++k) {
      const double before = speed;
      speed = along.Update(tick, wrench, holds, margin, kAxis_W, most);
      if (k > 0) {
        EXPECT_LE(std::abs(speed - before), gait.acceleration * 1e-3 + 1e-12);
      }
    }
    return speed;
  }
  double LeastReserve(FingerSet fingers) {
    double least = 10;
    for (int i : fingers) {
      const FingerPosture now = PostureAt(hand, i, AnglesOf(hand, i, estimate.q));
      least = std::min(least, SureReserve(hand, i, now, estimate.p_WO, kAxis_W, gait.limit_margin,
                                          10.0, control.reach));
    }
    return least;
  }
};

TEST_F(TurnAlongTest, TheFingerWithTheLeastReserveSetsThePace) {
  gait.along_speed = 10;  // far more than any finger can follow
  gait.along_ahead_s = 0.5;
  const double least = LeastReserve(all);
  ASSERT_GT(least, 0);
  EXPECT_NEAR(Settled(all, gait.along_margin, 10), least / gait.along_ahead_s, 1e-9);
  gait.along_ahead_s = 1.0;
  EXPECT_NEAR(Settled(all, gait.along_margin, 10), least, 1e-9);
  // A finger in the air does not count.
  for (int away : all)
    EXPECT_NEAR(Settled(all.without(away), gait.along_margin, 10), LeastReserve(all.without(away)),
                1e-9);
}

TEST_F(TurnAlongTest, NoFasterThanItMayAndSlowerWhereTheMarginIsScarce) {
  const double most = 0.05;
  ASSERT_LT(most * gait.along_ahead_s, LeastReserve(all));
  EXPECT_DOUBLE_EQ(Settled(all, 10 * gait.along_margin, most), most);
  const double half = 0.5 * (gait.margin_min + gait.along_margin);
  EXPECT_NEAR(Settled(all, half, most), 0.5 * most, 1e-12);
  EXPECT_EQ(Settled(all, gait.margin_min, most), 0);
  EXPECT_EQ(Settled(all, 0, most), 0);
}

TEST_F(TurnAlongTest, WaitsForAnObjectThatIsBehindItsReference) {
  EXPECT_GT(Settled(all, gait.along_margin, 0.05), 0);
  wrench.Move(1.1 * gait.lag_position * Vector3d::UnitX(), Vector3d::Zero(), 1.0);
  EXPECT_EQ(Settled(all, gait.along_margin, 0.05), 0);
  wrench.Start(estimate, gravity_W, control);
  EXPECT_GT(Settled(all, gait.along_margin, 0.05), 0);
  wrench.Move(Vector3d::Zero(), 1.1 * gait.lag_rotation * kAxis_W, 1.0);
  EXPECT_EQ(Settled(all, gait.along_margin, 0.05), 0);
}

}  // namespace
}  // namespace regrasp
