// Where the guided slide must not go: joint limits, the side of its link, out of its disc.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/exploration/slide_fixture.h"

namespace regrasp {
namespace {

TEST_F(SlideTest, AJointLimitIsAWall) {
  // The maximum lies at larger x than the start: the joint that carries it stops half way.
  const double way = Top().x() - StartAt(4e-3).x();
  hand_.joints[0].lower = -10;
  hand_.joints[0].upper = 10;
  const double half = 0.5 * way / kLever;
  (half > 0 ? hand_.joints[0].upper : hand_.joints[0].lower) =
      half + (half > 0 ? 1 : -1) * parameters_.limit_margin;
  Start();
  double deepest = 0;
  while (slide_.phase() != Phase::kDone) {
    Tick();
    deepest = std::max(deepest, (estimate_.q[0] - half) * (half > 0 ? 1 : -1) * kLever);
  }
  EXPECT_LT(deepest, 1e-3);  // the dither's circle has a radius of 0.5 mm
}

// On the side of its link, and its joint held by a limit that is in the way onto the round tip: it
// tries to leave for onto_tip_s, then explores where it is.
TEST_F(SlideTest, ExploresOnTheSideOfItsLinkThatItCannotLeave) {
  const Vector3d p = StartAt(4e-3), n = p.normalized();
  const Vector3d along = TangentPart(Vector3d::UnitX(), n).normalized();
  Shape capsule;
  capsule.radius = 0.007;
  capsule.b_L = p + capsule.radius * n + 3e-3 * along;  // its round end 3 mm ahead
  capsule.a_L = capsule.b_L - 0.02 * along;
  hand_.links[1].shapes = {capsule};
  hand_.joints[0].axis_J = Vector3d::UnitZ();
  hand_.joints[0].X_PJ.translation() = Vector3d(0, kLever, 0);
  hand_.joints[0].lower = -1e-3;
  ForwardKinematics(hand_, estimate_.q, &estimate_.kinematics);
  parameters_.onto_tip_s = 0.1;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  const int begin = ticks_;
  while (slide_.phase() == Phase::kExplore &&
         (ticks_ - begin) * kDt < 0.9 * parameters_.onto_tip_s) {
    Tick();
    ASSERT_EQ((estimate_.fingers[0].p_WC - p).norm(), 0) << "the limit";
  }
  ASSERT_EQ(slide_.phase(), Phase::kExplore);
  while (!slide_.slide_ended()) Tick();
  EXPECT_TRUE(slide_.end() == End::kGradient || slide_.end() == End::kNoGain);
  EXPECT_GT(slide_.phi_final(), slide_.phi_initial() + 0.01);

  // All of it counts for the time that a gait gives it.
  Place(p);
  ForwardKinematics(hand_, estimate_.q, &estimate_.kinematics);
  profile_.explore_s = 0.15;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  const int start = ticks_;
  while (slide_.phase() == Phase::kExplore) Tick();
  EXPECT_NEAR((ticks_ - start) * kDt, profile_.explore_s, 2 * kDt);
}

TEST_F(SlideTest, StaysInItsDiscAndEndsInside) {
  guide_.disc_centre_W = StartAt(4e-3);
  guide_.disc_radius = 1.5e-3;
  Start();
  double farthest = 0;
  while (!slide_.slide_ended()) {
    Tick();
    farthest = std::max(farthest, (estimate_.fingers[0].p_WC - guide_.disc_centre_W).norm());
  }
  EXPECT_LT(farthest, guide_.disc_radius + 1e-3);  // the dither's circle
  EXPECT_LT((estimate_.fingers[0].p_WC - guide_.disc_centre_W).norm(),
            guide_.disc_radius + parameters_.disc_slack + parameters_.arrived);
}

}  // namespace
}  // namespace regrasp
