#include "core/hand/box_gap.h"

#include <gtest/gtest.h>

#include "core/common/random.h"
#include "core/hand/scenario.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kStream = 9001;

PlacedBox At(const Vector3d& p_W, const Vector3d& axis, double angle, const Vector3d& half) {
  PlacedBox box;
  box.X_WB = Eigen::Translation3d(p_W) * Eigen::AngleAxisd(angle, axis);
  box.half_extents = half;
  return box;
}

const Vector3d kHalf(0.010, 0.010, 0.020), kAxis = Vector3d(1, 2, 3).normalized();

TEST(BoxGap, OfBoxesWhoseDistanceIsKnown) {
  const PlacedBox one = At(Vector3d::Zero(), Vector3d::UnitZ(), 0, kHalf);
  const auto two = [](double x, double angle) {
    return At({x, 0, 0.001}, Vector3d::UnitZ(), angle, kHalf);
  };
  EXPECT_NEAR(Gap(one, two(0.023, 0)), 0.003, 1e-15);   // face to face
  EXPECT_NEAR(Gap(one, two(0.018, 0)), -0.002, 1e-15);  // overlapping
  // Turned by 45 degrees its edge is 4.1 mm beyond the capsule inside it, and pierces the face.
  EXPECT_NEAR(Gap(one, two(0.023, M_PI / 4)), 0.013 - std::sqrt(2) * 0.010, 1e-15);
}

// An edge along z before one along y: no plane of a face is between them.
TEST(BoxGap, OfBoxesThatCrossEdgeToEdge) {
  const Vector3d cube = Vector3d::Constant(0.010);
  const PlacedBox one = At(Vector3d::Zero(), Vector3d::UnitZ(), M_PI / 4, cube);
  const PlacedBox two = At({0.031, 0, 0}, Vector3d::UnitY(), M_PI / 4, cube);
  EXPECT_NEAR(Gap(one, two), 0.031 - 2 * std::sqrt(2) * 0.010, 1e-15);
  EXPECT_NEAR(Gap(two, one), 0.031 - 2 * std::sqrt(2) * 0.010, 1e-15);
}

TEST(BoxGap, OfABoxAndAStraightLinkWhoseDistanceIsKnown) {
  const PlacedBox box = At(Vector3d::Zero(), Vector3d::UnitZ(), 0, kHalf);
  const Vector3d z(0, 0, 0.05);
  const Vector3d beside(0.020, 0, 0), diagonal(0.013, 0.014, 0), inside(0.005, 0.005, 0);
  EXPECT_NEAR(Gap(box, Bone{beside - z, beside + z, 0.004}), 0.006, 1e-15);
  EXPECT_NEAR(Gap(box, Bone{diagonal - z, diagonal + z, 0.004}), 0.001, 1e-15);
  EXPECT_NEAR(Gap(box, Bone{beside + Vector3d(0.003, 0, 0), beside, 0.004}), 0.006, 1e-15);
  EXPECT_EQ(Gap(box, Bone{inside - z, inside + z, 0.004}), -0.004);
}

// What is told as free is free: no pair of points of two bodies is nearer than the gap, and where
// bodies share a point there is none.
TEST(BoxGap, NoPairOfPointsIsNearer) {
  RandomStream random(1, kStream);
  const auto points = [](const PlacedBox& box) {
    std::vector<Vector3d> of;
    for (int n = 0; n < 729; ++n) {
      const Vector3d share(n % 9 - 4, n / 9 % 9 - 4, n / 81 - 4);
      of.push_back(box.X_WB * (share / 4).cwiseProduct(box.half_extents).eval());
    }
    return of;
  };
  int apart = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto some = [&](const Vector3d& p_W) {
      return At(p_W, random.Normal3().normalized(), trial, kHalf);
    };
    const PlacedBox one = some(Vector3d::Zero()), two = some(0.02 * random.Normal3());
    const Vector3d a = 0.03 * random.Normal3(), b = a + 0.02 * random.Normal3();
    const double boxes = Gap(one, two), link = Gap(one, Bone{a, b, 0.002});
    apart += boxes > 0;
    const std::vector<Vector3d> there = points(two);
    for (const Vector3d& p : points(one)) {
      for (const Vector3d& q : there) ASSERT_LE(boxes, (p - q).norm());
      for (int k = 0; k <= 50; ++k)
        ASSERT_LE(link, std::max(0.0, (p - a - k / 50.0 * (b - a)).norm() - 0.002) + 1e-6);
    }
  }
  EXPECT_GT(apart, 10);
  EXPECT_LT(apart, 50);
}

// Each of the last two links gets a box: it stands where the kinematics of the whole hand has it.
void ExpectBoxesOfTheLastTwoLinks(HandModel hand, const JointVector& q) {
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  Shape box;
  box.kind = Shape::Kind::kBox;
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const int last = hand.fingers[i].tip_link;
    const int before = hand.joints[hand.links[last].parent_joint].parent_link;
    FixedVector<PlacedBox, 2> expected;
    for (const int link : {last, before}) {
      box.X_LB = Eigen::Translation3d(0.001 * link, 0.01, 0) * Eigen::AngleAxisd(link, kAxis);
      box.half_extents = Vector3d(0.001 * link, 0.002, 0.003);
      hand.links[link].shapes.push_back(box);
      expected.push_back({data.X_WL[link] * box.X_LB, box.half_extents});
    }
    const Boxes boxes = BoxesOf(hand, i, PostureAt(hand, i, AnglesOf(hand, i, q)));
    ASSERT_EQ(boxes.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_LT((boxes[k].X_WB.matrix() - expected[k].X_WB.matrix()).norm(), 1e-12);
      EXPECT_EQ(boxes[k].half_extents, expected[k].half_extents);
    }
  }
}

TEST(BoxGap, BoxesAreThoseOfTheLastTwoLinks) {
  const LoadedScenario model = LoadScenario("allegro", "sphere", ModelSearchPath());
  ExpectBoxesOfTheLastTwoLinks(model.hand, model.scenario.q_closed);
}

TEST(BoxGap, BoxesOfAFingerWhoseLastJointFollowsTheFirst) {
  HandModel hand;
  hand.num_coupled = 1;
  hand.links.resize(3);
  hand.joints.resize(2);
  for (int j = 0; j < 2; ++j) {
    Joint& joint = hand.joints[j];
    joint.parent_link = j;
    joint.child_link = j + 1;
    joint.X_PJ.translation().z() = 0.04 * j;
    joint.lower = -1.5;
    joint.upper = 1.5;
    hand.links[j + 1].parent_joint = j;
  }
  hand.joints[1].driver = 0;
  hand.joints[1].ratio = 0.7;
  hand.joints[1].offset = 0.1;
  Shape tip;
  tip.b_L.z() = 0.04;
  tip.radius = 0.005;
  hand.links[2].shapes = {tip};
  hand.fingers.push_back({"only", {0}, 2, tip.b_L, tip.radius});
  JointVector q(1);
  q[0] = 0.5;
  ExpectBoxesOfTheLastTwoLinks(hand, q);
}

}  // namespace
}  // namespace regrasp
