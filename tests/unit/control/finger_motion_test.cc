#include "core/control/finger_motion.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/common/random.h"

namespace regrasp {
namespace {

std::vector<MovedPoint> Moved(const std::vector<Vector3d>& points, const Vector3d& dp,
                              const Vector3d& turn) {
  std::vector<MovedPoint> moved;
  for (const Vector3d& p : points) moved.push_back({p, dp + turn.cross(p)});
  return moved;
}

// Arms of 30 mm against the 2 mm below which a rotation is not told: 1 % of it at most.
TEST(FingerMotion, PointsOfARigidBodyTellItsMotion) {
  RandomStream random(1, 0);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 5; ++i) points.push_back(0.03 * random.Normal3().normalized());
    const Vector3d dp = 1e-4 * random.Normal3(), turn = 1e-3 * random.Normal3();
    const RigidStep step = FitStep(Moved(points, dp, turn));
    EXPECT_LT((step.turn_W - turn).norm(), 0.1 * turn.norm()) << trial;
    EXPECT_LT((step.At(step.about_W) - dp - turn.cross(step.about_W)).norm(), 1e-12) << trial;
    for (const Vector3d& p : points)
      EXPECT_LT((step.At(p) - dp - turn.cross(p)).norm(), 0.1 * 0.06 * turn.norm()) << trial;
  }
}

TEST(FingerMotion, TwoPointsDoNotTellTheTurnAboutTheirLine) {
  const std::vector<Vector3d> points = {{0.03, 0, 0}, {-0.03, 0, 0}};
  const RigidStep step = FitStep(Moved(points, {0, 0, 1e-4}, {0.01, 0.002, 0}));
  EXPECT_NEAR(step.turn_W.x(), 0, 1e-12);
  EXPECT_NEAR(step.turn_W.y(), 0.002, 2e-5);
  EXPECT_NEAR(step.At({0, 0, 0}).z(), 1e-4, 1e-12);
}

TEST(FingerMotion, NoPointsNoMotion) {
  const RigidStep step = FitStep({});
  EXPECT_EQ(step.At({1, 2, 3}), Vector3d::Zero());
}

}  // namespace
}  // namespace regrasp
