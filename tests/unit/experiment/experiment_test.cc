#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cli/experiment/statistics.h"
#include "cli/experiment/straight_slide.h"
#include "core/exploration/surface_exploration.h"

namespace regrasp::cli {
namespace {

constexpr double kZ = 1.959963984540054;

TEST(WilsonInterval, EndsSolveTheScoreEquation) {
  // The definition: p is an end of the interval where |k/n - p| = z sqrt(p (1 - p) / n).
  for (const int n : {1, 3, 10, 50, 250})
    for (int k = 0; k <= n; ++k) {
      const Interval interval = WilsonInterval(k, n);
      const double share = static_cast<double>(k) / n;
      for (const double p : {interval.low, interval.high})
        // 1e-12: rounding of a quotient of order 1.
        EXPECT_NEAR(std::abs(share - p), kZ * std::sqrt(p * (1 - p) / n), 1e-12) << k << "/" << n;
      EXPECT_LE(interval.low, share);
      EXPECT_GE(interval.high, share);
    }
}

TEST(WilsonInterval, FiftyOfFiftyIsNoCertainty) {
  const Interval interval = WilsonInterval(50, 50);
  EXPECT_NEAR(interval.low, 50 / (50 + kZ * kZ), 1e-12);  // closed form at k = n
  EXPECT_EQ(interval.high, 1.0);
  EXPECT_EQ(WilsonInterval(0, 50).low, 0.0);
}

TEST(WilsonInterval, NothingTriedSaysNothing) {
  EXPECT_EQ(WilsonInterval(0, 0).low, 0.0);
  EXPECT_EQ(WilsonInterval(0, 0).high, 1.0);
}

TEST(Quantile, IsLinearBetweenOrderStatistics) {
  const std::vector<double> values = {1, 2, 4, 8};
  EXPECT_EQ(Quantile(values, 0), 1);
  EXPECT_EQ(Quantile(values, 1), 8);
  EXPECT_EQ(Quantile(values, 0.5), 3);
  EXPECT_DOUBLE_EQ(Quantile(values, 0.9), 4 + 0.7 * 4);  // place 2.7
  EXPECT_EQ(Quantile({5}, 0.25), 5);
}

TEST(SeedOfDirection, IsWhereAlgorithmOneStarts) {
  SurfaceExploration::Input input;
  input.normal_W = Vector3d(0.3, -0.5, 0.8).normalized();
  const Matrix3d R_WC = RotationFromZ(input.normal_W);
  ExplorationParameters parameters;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2 * std::numbers::pi * i / 12;
    SurfaceExploration exploration;
    exploration.Start(input, Estimator::kSecant, static_cast<std::uint64_t>(SeedOfDirection(angle)),
                      1, parameters);
    const Vector3d gradient_C = R_WC.transpose() * exploration.gradient_W();
    const double off =
        std::remainder(std::atan2(gradient_C.y(), gradient_C.x()) - angle, 2 * std::numbers::pi);
    EXPECT_LT(std::abs(off), std::numbers::pi / 360 + 1e-12);  // as promised, and rounding
  }
}

}  // namespace
}  // namespace regrasp::cli
