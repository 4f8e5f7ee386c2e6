#include "tests/unit/control/truncated_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace regrasp {
namespace {

TEST(ProjectOntoTruncatedCone, FulfilsTheOptimalityConditionOfAProjection) {
  RandomStream random(1, 0);
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector3d axis = RandomDirection(&random);
    const double mu = Uniform(&random, 0.05, 1.0), lower = Uniform(&random, 0.0, 0.5);
    const double cap = lower + Uniform(&random, 0.0, 4.0);
    const Vector3d f = Uniform(&random, 0.0, 8.0) * RandomDirection(&random);
    const Vector3d p = ProjectOntoTruncatedCone(f, axis, mu, lower, cap);
    ASSERT_LE(Violation(p, axis, mu, lower, cap), 1e-12);  // rounding of numbers below 10
    // p is the projection onto a convex set exactly when (f - p).(x - p) <= 0 for all x in it.
    // 1e-11: rounding of products of forces up to 8 N.
    ASSERT_LE(SupportOfTruncatedCone(f - p, axis, mu, lower, cap) - (f - p).dot(p), 1e-11);
  }
}

TEST(ProjectOntoTruncatedCone, NoSampleOfTheConeIsNearer) {
  RandomStream random(2, 0);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d axis = RandomDirection(&random);
    const Matrix3d R = RotationFromZ(axis);
    const double mu = Uniform(&random, 0.1, 1.0), lower = 0.1, cap = 4.0;
    const Vector3d f = Uniform(&random, 0.0, 8.0) * RandomDirection(&random);
    const double distance = (f - ProjectOntoTruncatedCone(f, axis, mu, lower, cap)).norm();
    double nearest = 1e9;
    for (int i = 0; i <= 60; ++i)
      for (int j = 0; j <= 20; ++j)
        for (int k = 0; k < 90; ++k) {
          const double n = lower + (cap - lower) * i / 60, t = mu * n * j / 20;
          const double a = 2 * std::numbers::pi * k / 90;
          nearest =
              std::min(nearest, (f - R * Vector3d(t * std::cos(a), t * std::sin(a), n)).norm());
        }
    EXPECT_GE(nearest, distance - 1e-12);
    // The grid's spacing is below 0.065 N along n, 0.2 N along t and 0.28 N around.
    EXPECT_LE(nearest, distance + 0.2);
  }
}

TEST(ProjectOntoTruncatedCone, KeepsWhatIsInside) {
  const Vector3d f(0.3, 0.2, 1.0);
  EXPECT_EQ(ProjectOntoTruncatedCone(f, Vector3d::UnitZ(), 0.5, 0.1, 4.0), f);
}

TEST(ProjectOntoTruncatedCone, CapBelowLowerMeansLower) {
  const Vector3d f = ProjectOntoTruncatedCone({3, 0, 5}, Vector3d::UnitZ(), 0.5, 0.1, 0.05);
  EXPECT_NEAR(f.z(), 0.1, 1e-15);
  EXPECT_NEAR(f.x(), 0.05, 1e-15);
}

}  // namespace
}  // namespace regrasp
