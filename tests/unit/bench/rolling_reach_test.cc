// How far a ball can turn between tips that roll on it: fingers whose way is known by hand.

#include "bench/rolling_reach.h"

#include <gtest/gtest.h>

namespace regrasp {
namespace {

constexpr double kBall = 0.025, kTip = 0.007, kLink = 0.04;
constexpr double kFar = 3.0;  // a limit that nothing comes to [rad]

/// A finger in the plane across z, hinged at the origin. Its first link, as long as tip and ball
/// reach together, stays parallel to the line from the ball's centre to the tip; the second, of
/// `kLink` along x, does not turn then: a parallelogram with the ball's centre at (kLink, 0, 0).
/// The third joint turns the tip about its own centre.
HandModel Parallelogram(double lower_1, double upper_1, double lower_3, double upper_3) {
  HandModel hand;
  hand.links.resize(4);
  hand.joints.resize(3);
  const double x[] = {0, kBall + kTip, kLink};
  const double lower[] = {lower_1, -kFar, lower_3}, upper[] = {upper_1, kFar, upper_3};
  for (int j = 0; j < 3; ++j) {
    Joint& joint = hand.joints[j];
    joint.parent_link = j;
    joint.child_link = j + 1;
    joint.axis_J = Vector3d::UnitZ();
    joint.X_PJ.translation() = Vector3d(x[j], 0, 0);
    joint.lower = lower[j];
    joint.upper = upper[j];
    hand.links[j + 1].parent_joint = j;
  }
  Finger finger;
  finger.joints = {0, 1, 2};
  finger.tip_link = 3;
  finger.tip_radius = kTip;
  hand.fingers.push_back(finger);
  return hand;
}

const Ball kTheBall{Vector3d(kLink, 0, 0), kBall};

/// The tip touches the ball in the direction `angle` from its centre.
JointVector Touching(double angle) {
  JointVector q(3);
  q << angle, -angle, 0;
  return q;
}

// Steps are first order: of 1.5 rad in 50 they miss less than 2 % and one step.
constexpr double kTolerance = 0.03;

// A tip that does not turn is a gear: the point of contact goes round the ball with R / (R + r) of
// the ball's own turn, and the first joint with it.
TEST(RollingReach, OfATipThatCannotTurnIsThatOfAGear) {
  const HandModel hand = Parallelogram(0, 1.2, -1e-6, 1e-6);
  const BallWay way{Vector3d::UnitZ(), 1.5};
  const double gear = (kBall + kTip) / kBall;
  for (const double start : {0.3, 0.6, 0.9}) {
    const RollingEnd end = FarthestRolling(hand, 0, Touching(start), kTheBall, way);
    EXPECT_NEAR(end.angle, (1.2 - start) * gear, kTolerance) << start;
    EXPECT_EQ(end.joint, 0);
  }
  const RollingEnd back = FarthestRolling(Parallelogram(0.3, 1.2, -1e-6, 1e-6), 0, Touching(0.9),
                                          kTheBall, {-Vector3d::UnitZ(), 1.5});
  EXPECT_NEAR(back.angle, 0.6 * gear, kTolerance);
  EXPECT_EQ(back.joint, 0);
  // No limit in the way.
  EXPECT_EQ(FarthestRolling(hand, 0, Touching(0.4), kTheBall, {Vector3d::UnitZ(), 0.5}).joint, -1);
}

// A tip that turns by b against the ball takes r b of the way off the first joint: R a - r b =
// (R + r) (way of the joint). The search has to find that turning it all the way back is best.
TEST(RollingReach, IsFoundByTurningTheRedundantJointAllTheWay) {
  const double gear = (kBall + kTip) / kBall, way = 0.7, back = 0.8;
  const HandModel hand = Parallelogram(0, 1.2, -back, kFar);
  const RollingEnd end =
      FarthestRolling(hand, 0, Touching(1.2 - way), kTheBall, {Vector3d::UnitZ(), 1.5});
  EXPECT_NEAR(end.angle, way * gear + back * kTip / kBall, kTolerance);
  EXPECT_EQ(end.joint, 0);
}

TEST(RollingReach, OfAllFingersIsThatOfTheShortestOnTheBestWay) {
  HandModel hand = Parallelogram(0, 1.2, -1e-6, 1e-6);
  hand.fingers.push_back(hand.fingers[0]);
  const JointVector q = Touching(0.6);
  const RollingReach reach = FarthestTurn(hand, {0, 1}, q, kTheBall, Vector3d::UnitZ(), 1.5, {});
  const double alone = FarthestRolling(hand, 0, q, kTheBall, {Vector3d::UnitZ(), 1.5}).angle;
  EXPECT_DOUBLE_EQ(reach.angle, alone);
  EXPECT_EQ(reach.joint, 0);
  ASSERT_EQ(reach.alone.size(), 2u);
  EXPECT_DOUBLE_EQ(reach.alone[1].angle, alone);
  // A ball whose centre may move by d along the way of the tip gains d of it: R a + d = (R + r)
  // way. The directions looked at are 45 degrees apart.
  const RollingReach shifted =
      FarthestTurn(hand, {0}, q, kTheBall, Vector3d::UnitZ(), 1.5, {.shift = 0.003});
  EXPECT_NEAR(shifted.angle, alone + 0.003 / kBall, kTolerance);
}

}  // namespace
}  // namespace regrasp
