// The reference follows an error that lasts, and motions win it back.

#include "core/gait/forgiveness.h"

#include <gtest/gtest.h>

#include "core/shape/felt_surface.h"

namespace regrasp {
namespace {

class ForgivenessTest : public ::testing::Test {
 protected:
  HandModel hand;
  Estimate estimate;
  LoadMargins margins;
  FeltSurface felt;
  Vector3d gravity_W{0, 0, -9.81};
  ControlParameters control;
  ExplorationParameters exploration;
  GaitParameters gait;
  ObjectWrench wrench;
  Forgiveness forgiveness;
  const Vector3d axis_W = -Vector3d::UnitZ();

  void SetUp() override {
    estimate.p_WO = {0.01, 0.02, 0.30};
    wrench.Start(estimate, gravity_W, control);
    forgiveness.Start(wrench);
    margins.all = 2 * gait.forgive_margin;
  }
  ControlTick Tick() {
    return {hand,      estimate, FingerSet(), margins, felt,
            gravity_W, control,  exploration, gait,    1e-3};
  }
  double Forgive(bool held = false) { return forgiveness.Forgive(Tick(), axis_W, held, &wrench); }
};

TEST_F(ForgivenessTest, FollowsALargeErrorAndKeepsTheFingersTrying) {
  estimate.p_WO += Vector3d(0.005, 0, 0);
  EXPECT_EQ(Forgive(), 0);  // a shift is no turn
  EXPECT_EQ(forgiveness.times(), 1);
  EXPECT_NEAR((wrench.p_ref() - estimate.p_WO).norm(), gait.forgive_position, 1e-12);
  EXPECT_NEAR(forgiveness.offset_owed(wrench), 0.005 - gait.forgive_position, 1e-12);
}

TEST_F(ForgivenessTest, LeavesASmallErrorToTheController) {
  estimate.p_WO += Vector3d(0.9 * gait.recovered * gait.abort_position, 0, 0);
  Forgive();
  EXPECT_EQ(forgiveness.times(), 0);
  EXPECT_EQ(forgiveness.offset_owed(wrench), 0);
}

TEST_F(ForgivenessTest, DoesNotFollowAnObjectThatFalls) {
  margins.all = 0;
  const auto hold = [&](double fall_m_s) {  // as long as a hold may last
    for (double t = 0; t < gait.recover_limit_s; t += 0.01) {
      estimate.p_WO.z() -= 0.01 * fall_m_s;
      forgiveness.Watch(Tick(), t);
    }
  };
  hold(0.01);
  Forgive(true);
  EXPECT_EQ(forgiveness.times(), 0);
  // Resting, it is where it is.
  hold(0);
  Forgive(true);
  EXPECT_EQ(forgiveness.times(), 1);
}

TEST_F(ForgivenessTest, BooksTheTwistAndOwesTheTilt) {
  const Vector3d tilt(0.3, 0, 0);
  estimate.q_WO = FromRotationVector(tilt) * FromRotationVector(0.4 * axis_W);
  const double turned = Forgive();
  EXPECT_NEAR(turned, 0.4, 0.08);  // gait.forgive_rotation of the error stays
  const double owed = forgiveness.tilt_owed(wrench, axis_W, turned);
  EXPECT_NEAR(owed, tilt.norm(), gait.forgive_rotation + 0.02);
  // A motion wins back no more than its share, and towards where the object was.
  const ObjectMotion per_rad = forgiveness.WinBack(gait, wrench, axis_W, turned, 0.35);
  EXPECT_NEAR(0.35 * per_rad.w_W.norm(), gait.win_back_rotation, 1e-12);
  EXPECT_LT(per_rad.w_W.dot(tilt), 0);
  wrench.Move(Vector3d::Zero(), per_rad.w_W, 0.35);
  EXPECT_NEAR(forgiveness.tilt_owed(wrench, axis_W, turned), owed - gait.win_back_rotation, 0.01);
}

TEST_F(ForgivenessTest, CanBeSwitchedOff) {
  gait.forgive = false;
  estimate.p_WO += Vector3d(0.05, 0, 0);
  Forgive(true);
  EXPECT_EQ(forgiveness.times(), 0);
}

}  // namespace
}  // namespace regrasp
