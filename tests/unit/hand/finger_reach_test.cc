// A finger by itself against the kinematics of the whole hand.

#include "core/hand/finger_reach.h"

#include <gtest/gtest.h>

namespace regrasp {
namespace {

/// One finger of two driven joints, a coupled one between them and one at the tip.
HandModel CoupledFinger() {
  HandModel hand;
  hand.links.resize(5);
  hand.joints.resize(4);
  hand.num_coupled = 2;
  const std::array<int, 4> order = {0, 2, 1, 3};  // joints from the palm to the tip
  for (int n = 0; n < 4; ++n) {
    Joint& joint = hand.joints[order[n]];
    joint.parent_link = n;
    joint.child_link = n + 1;
    joint.X_PJ.translation() = Vector3d(0.002 * n, 0.01, 0.03);
    joint.X_PJ.linear() = Eigen::AngleAxisd(0.2 * n, Vector3d::UnitZ()).toRotationMatrix();
    joint.axis_J = n == 0 ? Vector3d::UnitY() : Vector3d::UnitX();
    joint.lower = -2;
    joint.upper = 2;
    hand.links[n + 1].parent_joint = order[n];
  }
  hand.joints[2].driver = 0;
  hand.joints[2].ratio = 0.7;
  hand.joints[2].offset = 0.1;
  hand.joints[3].driver = 1;
  hand.joints[3].ratio = -1.2;
  Finger finger;
  finger.joints = {0, 1};
  finger.tip_link = 4;
  finger.p_LF = Vector3d(0, 0.004, 0.02);
  hand.fingers.push_back(finger);
  return hand;
}

TEST(FingerReach, FollowsCoupledJoints) {
  const HandModel hand = CoupledFinger();
  const JointVector q = JointVector::Map(std::array{0.4, -0.6}.data(), 2);
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  const FingerPosture posture = PostureAt(hand, 0, AnglesOf(hand, 0, q));
  const Vector3d p_WF = FingertipCentre(hand, data, 0);
  EXPECT_LT((posture.p_WF - p_WF).norm(), 1e-12);
  EXPECT_LT((posture.J - PointJacobian(hand, data, 0, p_WF)).norm(), 1e-12);
  ASSERT_EQ(ChainOf(hand, 0).size(), 4u);
  EXPECT_EQ(ChainOf(hand, 0)[1], 2);
  // What it reaches, the hand reaches with the same angles.
  const JointVector q_there = JointVector::Map(std::array{0.5, -0.3}.data(), 2);
  ForwardKinematics(hand, q_there, &data);
  const Vector3d there = FingertipCentre(hand, data, 0);
  const FingerPosture reached = ReachFor(hand, 0, posture, there, 0.0, 50);
  EXPECT_LT((reached.p_WF - there).norm(), 3e-4);
}

/// A finger of one joint about the axis about which the object turns: its tip goes round with it.
HandModel FingerOnTheAxis(double lower, double upper) {
  HandModel hand;
  hand.links.resize(2);
  hand.joints.resize(1);
  Joint& joint = hand.joints[0];
  joint.parent_link = 0;
  joint.child_link = 1;
  joint.axis_J = Vector3d::UnitZ();
  joint.lower = lower;
  joint.upper = upper;
  hand.links[1].parent_joint = 0;
  Finger finger;
  finger.joints = {0};
  finger.tip_link = 1;
  finger.p_LF = Vector3d(0.03, 0, 0);
  hand.fingers.push_back(finger);
  return hand;
}

double ReserveAt(const HandModel& hand, double q, const Vector3d& axis_W, double most) {
  const FingerPosture from = PostureAt(hand, 0, FingerVector::Constant(1, q));
  return MotionReserve(hand, 0, from, Vector3d::Zero(), axis_W, 0.03, most, {});
}

// The joint turns by what the object turns: the reserve is the way to the limit, whose derivative
// is -1 by the angle in one sense and +1 in the other.
TEST(MotionReserve, IsTheWayToTheLimitOfAFingerOnTheAxis) {
  const HandModel hand = FingerOnTheAxis(-0.7, 0.9);
  // The damping of J⁺ against a lever of 30 mm leaves 0.1 % of a step of 0.06 rad to the next one.
  constexpr double kTolerance = 2e-3, kStep = 0.01;
  const Vector3d z = Vector3d::UnitZ();
  for (double q = -0.5; q < 0.6; q += 0.07) {
    EXPECT_NEAR(ReserveAt(hand, q, z, 2), 0.9 - 0.03 - q, kTolerance) << q;
    EXPECT_NEAR(ReserveAt(hand, q, -z, 2), q + 0.7 - 0.03, kTolerance) << q;
    const auto slope = [&](const Vector3d& axis) {
      return (ReserveAt(hand, q + kStep, axis, 2) - ReserveAt(hand, q - kStep, axis, 2)) /
             (2 * kStep);
    };
    EXPECT_NEAR(slope(z), -1, 0.05) << q;
    EXPECT_NEAR(slope(-z), 1, 0.05) << q;
  }
  EXPECT_EQ(ReserveAt(hand, 0, z, 0.4), 0.4);                 // no more is asked for
  EXPECT_EQ(ReserveAt(hand, 0, Vector3d::Zero(), 0.4), 0.4);  // nothing turns
  EXPECT_EQ(ReserveAt(hand, 0.89, z, 2), 0);                  // beyond the margin already
  // Across the axis it cannot follow at all.
  EXPECT_LT(ReserveAt(hand, 0, Vector3d::UnitY(), 2), 0.15);
}

TEST(BonesOf, MeetTheNarrowSidesOfABox) {
  Shape box;
  box.kind = Shape::Kind::kBox;
  box.half_extents = {0.02, 0.01, 0.006};
  const Bones flat = BonesOf(box, Isometry3d::Identity());
  ASSERT_EQ(flat.size(), 2u);
  for (const Bone& bone : flat) {
    EXPECT_DOUBLE_EQ(bone.radius, 0.006);
    EXPECT_NEAR(std::abs(bone.a_W.x()) + bone.radius, 0.02, 1e-12);
    EXPECT_NEAR(std::abs(bone.a_W.y()) + bone.radius, 0.01, 1e-12);
    EXPECT_NEAR(bone.a_W.z(), 0, 1e-12);
  }
  box.half_extents = {0.01, 0.01, 0.02};
  const Bones square = BonesOf(box, Isometry3d::Identity());
  ASSERT_EQ(square.size(), 1u);
  EXPECT_NEAR((square[0].a_W - square[0].b_W).norm(), 0.02, 1e-12);
  box.half_extents = Vector3d::Constant(0.01);
  EXPECT_NEAR((BonesOf(box, Isometry3d::Identity())[0].a_W).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace regrasp
