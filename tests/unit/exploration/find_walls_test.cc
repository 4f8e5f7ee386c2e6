#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "core/exploration/walls.h"
#include "core/hand/finger_reach.h"
#include "tests/unit/control/held_sphere.h"

namespace regrasp {
namespace {

class WallsTest : public ::testing::Test {
 protected:
  const LoadedScenario scenario_ = ShadowHand();
  const HandModel& hand_ = scenario_.hand;
  const Estimate estimate_ = TouchingEstimate(hand_, GraspPosture(hand_));

  /// `from` after the least joint motion of a finger that moves its contact by `way_W` [m]; the
  /// contact itself is left where it was.
  Estimate Moved(const Estimate& from, int finger, const Vector3d& way_W) const {
    const auto& joints = hand_.fingers[static_cast<std::size_t>(finger)].joints;
    const FingerVector dq =
        from.fingers[static_cast<std::size_t>(finger)].J.completeOrthogonalDecomposition().solve(
            way_W);
    Estimate moved = from;
    for (std::size_t k = 0; k < joints.size(); ++k)
      moved.q[joints[k]] += dq[static_cast<Eigen::Index>(k)];
    ForwardKinematics(hand_, moved.q, &moved.kinematics);
    return moved;
  }
};

// At a joint's limit there is a wall, and the contact motion into it is one that would move that
// joint further out; on the other side of the limit's margin there is none.
TEST_F(WallsTest, JointLimitsAreWalls) {
  ExplorationParameters parameters;
  parameters.clearance = -1;    // other fingers apart
  parameters.least_facing = 1;  // the end of the round tip apart
  Walls walls;
  int found = 0;
  for (int finger = 0; finger < hand_.num_fingers(); ++finger) {
    for (const int j : hand_.fingers[static_cast<std::size_t>(finger)].joints) {
      const Joint& joint = hand_.joints[static_cast<std::size_t>(j)];
      for (const bool upper : {false, true}) {
        JointVector q = GraspPosture(hand_);
        for (const int other : hand_.fingers[static_cast<std::size_t>(finger)].joints) {
          const Joint& o = hand_.joints[static_cast<std::size_t>(other)];
          q[other] = 0.5 * (o.lower + o.upper);
        }
        FindWalls(hand_, TouchingEstimate(hand_, q), finger, parameters, OnSide::kLeave, &walls);
        EXPECT_TRUE(walls.empty());
        const double inset = 0.5 * parameters.limit_margin;
        q[j] = upper ? joint.upper - inset : joint.lower + inset;
        const Estimate e = TouchingEstimate(hand_, q);
        FindWalls(hand_, e, finger, parameters, OnSide::kLeave, &walls);
        for (const Wall& wall : walls) {
          ++found;
          const FingerEstimate& f = e.fingers[static_cast<std::size_t>(finger)];
          EXPECT_NEAR(wall.direction_W.norm(), 1, 1e-12);
          EXPECT_NEAR(wall.direction_W.dot(f.normal_W), 0, 1e-12);
          EXPECT_GT(wall.depth, 0);
          // The least joint motion that moves the contact into the wall.
          const FingerVector motion = f.J.completeOrthogonalDecomposition().solve(wall.direction_W);
          Eigen::Index k = 0;
          while (
              hand_.fingers[static_cast<std::size_t>(finger)].joints[static_cast<std::size_t>(k)] !=
              j)
            ++k;
          EXPECT_GT((upper ? 1 : -1) * motion[k], 0) << joint.name << (upper ? " upper" : " lower");
        }
      }
    }
  }
  EXPECT_GT(found, 22);  // of 44 limits; those along the normal are no walls
}

TEST_F(WallsTest, ANeighbourIsAWallFromTheClearanceOn) {
  ExplorationParameters parameters;
  parameters.limit_margin = -1;  // joint limits apart
  Walls walls;
  parameters.clearance = 0;  // the posture keeps links 3 mm apart
  FindWalls(hand_, estimate_, 1, parameters, OnSide::kLeave, &walls);
  EXPECT_TRUE(walls.empty());
  parameters.clearance = 0.2;  // everything is near
  FindWalls(hand_, estimate_, 1, parameters, OnSide::kLeave, &walls);
  EXPECT_GT(walls.size(), 8u);  // of four links against each of theirs, less those that part
  EXPECT_FALSE(walls.full());   // room for whoever adds one
  for (const Wall& wall : walls) EXPECT_TRUE(wall.direction_W.allFinite());
}

// The depth of a wall is the way back out of it: against finite differences of the posture, with a
// clearance at which the links have just met.
TEST_F(WallsTest, AWallsDepthGrowsByTheWayIntoIt) {
  ExplorationParameters parameters;
  parameters.limit_margin = -1;
  parameters.least_facing = 1;
  constexpr double kStep = 1e-5, kJustMet = 1e-4;  // m
  int seen = 0;
  for (int finger = 0; finger < hand_.num_fingers(); ++finger) {
    for (int k = 0; k < 300; ++k) {
      parameters.clearance = 1e-4 * k;
      Walls before, after;
      FindWalls(hand_, estimate_, finger, parameters, OnSide::kLeave, &before);
      for (std::size_t w = 0; w < before.size(); ++w) {
        if (before[w].depth > kJustMet) continue;
        const Estimate moved = Moved(estimate_, finger, kStep * before[w].direction_W);
        FindWalls(hand_, moved, finger, parameters, OnSide::kLeave, &after);
        if (after.size() != before.size()) continue;  // another pair has met or parted
        // 5 %: the 1 mm of damping in J⁺ against singular values of 20 mm and more.
        EXPECT_NEAR((after[w].depth - before[w].depth) / kStep, 1, 0.05) << finger << " wall " << w;
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 5);
}

// On the side of the link the wall is blind, and its depth is the way back onto the round end:
// against finite differences of the posture, of a finger whose link lies on the object.
TEST_F(WallsTest, TheSideOfTheLinkIsABlindWallWithTheRoundTipBehindIt) {
  ExplorationParameters parameters;
  parameters.limit_margin = parameters.clearance = -1;  // joint limits and other fingers apart
  constexpr double kUp = 4e-3, kStep = 1e-5;            // m
  int seen = 0;
  for (int finger = 0; finger < hand_.num_fingers(); ++finger) {
    const Finger& model = hand_.fingers[static_cast<std::size_t>(finger)];
    const Shape& shape = hand_.links[static_cast<std::size_t>(model.tip_link)].shapes[0];
    ASSERT_EQ(shape.kind, Shape::Kind::kCapsule);
    Estimate e = estimate_;
    FingerEstimate& f = e.fingers[static_cast<std::size_t>(finger)];
    const auto End = [&] { return e.kinematics.X_WL[model.tip_link] * shape.b_L; };
    const auto Along = [&] {
      return (e.kinematics.X_WL[model.tip_link].linear() * (shape.b_L - shape.a_L)).normalized();
    };
    f.normal_W = TangentPart(f.normal_W, Along()).normalized();
    f.p_WC = End() - kUp * Along() - shape.radius * f.normal_W;
    f.J = PointJacobian(hand_, e.kinematics, finger, f.p_WC);
    const Vector3d p_WO = f.p_WC - e.object_scale * f.normal_W;
    const auto Up = [&] { return (End() - p_WO).dot(Along()); };
    ASSERT_NEAR(Up(), kUp, 1e-9);
    Walls walls;
    FindWalls(hand_, e, finger, parameters, OnSide::kLeave, &walls);
    ASSERT_EQ(walls.size(), 1u);
    if (!walls[0].blind()) continue;  // it cannot move along its link
    e = Moved(e, finger, -kStep * walls[0].direction_W);
    EXPECT_NEAR((kUp - Up()) / kUp, kStep / walls[0].depth, 0.05 * kStep / walls[0].depth)
        << finger;
    ++seen;
    f.p_WC += (kUp - 3e-4) * Along();  // as good as on the round end
    FindWalls(hand_, e, finger, parameters, OnSide::kLeave, &walls);
    for (const Wall& wall : walls) EXPECT_FALSE(wall.blind());
    f.p_WC -= (kUp - 3e-4) * Along();
    FindWalls(hand_, e, finger, parameters, OnSide::kStay, &walls);
    for (const Wall& wall : walls) EXPECT_FALSE(wall.blind());
  }
  EXPECT_GE(seen, 3);
}

// Where the last link has more than its fingertip, that comes no nearer to the object than the
// clearance: against finite differences of the posture.
TEST_F(WallsTest, TheRestOfTheLastLinkIsAWallFromTheClearanceOn) {
  ExplorationParameters parameters;
  parameters.limit_margin = -1;
  parameters.least_facing = 1;
  constexpr double kStep = 1e-5, kGap = 1e-3;  // m
  int seen = 0;
  for (int finger = 0; finger < hand_.num_fingers(); ++finger) {
    const FingerEstimate& f = estimate_.fingers[static_cast<std::size_t>(finger)];
    const Finger& model = hand_.fingers[static_cast<std::size_t>(finger)];
    const Isometry3d& X_WL = estimate_.kinematics.X_WL[model.tip_link];
    const Vector3d p_WO = f.p_WC - estimate_.object_scale * f.normal_W;
    const Matrix3d R_WC = RotationFromZ(f.normal_W);
    for (int k = 0; k < 8; ++k) {
      SCOPED_TRACE(fmt::format("finger {}, direction {}", finger, k));
      // A box, one of whose faces or corners is nearest to the object's centre, or a ball.
      const Vector3d out =
          (R_WC * Vector3d(std::cos(M_PI / 4 * k), std::sin(M_PI / 4 * k), 0.5)).normalized();
      Shape rest;
      if (k % 2 == 0) {
        rest.kind = Shape::Kind::kBox;
        rest.half_extents = Vector3d(4e-3, 6e-3, 9e-3);
        Matrix3d R_WB = RotationFromZ(out);
        Vector3d nearest(1e-3, -2e-3, -rest.half_extents.z());
        if (k % 4 == 2) {
          R_WB = R_WB * RotationFromZ(rest.half_extents.normalized()).transpose();
          nearest = -rest.half_extents;
        }
        rest.X_LB = Isometry3d::Identity();
        rest.X_LB.linear() = X_WL.linear().transpose() * R_WB;
        rest.X_LB.translation() =
            X_WL.inverse() * (p_WO + (estimate_.object_scale + kGap) * out - R_WB * nearest);
      } else {
        rest.kind = Shape::Kind::kCapsule;
        rest.radius = 5e-3;
        rest.a_L = rest.b_L =
            X_WL.inverse() * (p_WO + (estimate_.object_scale + kGap + rest.radius) * out);
      }
      HandModel hand = hand_;
      hand.links[static_cast<std::size_t>(model.tip_link)].shapes.push_back(rest);
      Walls walls;
      parameters.clearance = 0.9 * kGap;
      FindWalls(hand, estimate_, finger, parameters, OnSide::kLeave, &walls);
      ASSERT_TRUE(walls.empty());
      parameters.clearance = 1.1 * kGap;
      FindWalls(hand, estimate_, finger, parameters, OnSide::kLeave, &walls);
      ASSERT_LE(walls.size(), 1u);
      if (walls.empty()) continue;  // it does not come nearer
      ++seen;
      const Estimate moved = Moved(estimate_, finger, kStep * walls[0].direction_W);
      Walls after;
      FindWalls(hand, moved, finger, parameters, OnSide::kLeave, &after);
      ASSERT_EQ(after.size(), 1u);
      EXPECT_NEAR((after[0].depth - walls[0].depth) / kStep, 1, 0.05);
    }
  }
  EXPECT_GT(seen, 10);
}

}  // namespace
}  // namespace regrasp
