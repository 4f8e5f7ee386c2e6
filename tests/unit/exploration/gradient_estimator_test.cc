#include "core/exploration/gradient_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/common/random.h"

namespace regrasp {
namespace {

Matrix3d RandomFrame(RandomStream* random) { return RotationFromZ(random->Normal3().normalized()); }

// The example of docs/paper_map.md, line 5: with T as printed (C to W) instead of its inverse, a
// slip of (2.0, -1.0)e-4 came back as (-1.4, 0.2)e-4. A change of phi of 1 makes the secant 1 /
// slip, component by component.
TEST(SecantEstimator, LineFiveSeesASlipInTheContactFrame) {
  RandomStream random(1, 0);
  for (int trial = 0; trial < 1000; ++trial) {
    const Matrix3d R_WC = RandomFrame(&random);
    const Vector3d slip_C(2.0e-4, -1.0e-4, 0);
    const Vector3d p_prev = 0.1 * random.Normal3(), p = p_prev + R_WC * slip_C;
    const Vector3d g = SecantEstimator::Gradient(p_prev, 0.0, p, 1.0, R_WC, 1e-4);
    // p of 0.1 m leaves 1e-17 m of rounding in a slip of 1e-4 m.
    EXPECT_NEAR(1 / g.x() / slip_C.x(), 1, 1e-11);
    EXPECT_NEAR(1 / g.y() / slip_C.y(), 1, 1e-11);
    EXPECT_EQ(g.z(), 0);
  }
}

TEST(SecantEstimator, IsExactAlongAnAxis) {
  RandomStream random(2, 0);
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix3d R_WC = RandomFrame(&random);
    const Vector3d g_C(37, -12, 0), p_prev = 0.1 * random.Normal3();
    for (int axis = 0; axis < 2; ++axis) {
      const Vector3d step = R_WC.col(axis) * (random.Uniform() < 0.5 ? 3e-4 : -3e-4);
      const double change = (R_WC * g_C).dot(step);
      const Vector3d g =
          SecantEstimator::Gradient(p_prev, 1.0, p_prev + step, 1.0 + change, R_WC, 3e-4);
      EXPECT_NEAR(g[axis], g_C[axis], 1e-9);  // phi of 1 has 2e-16 of rounding, over 3e-4 m
      EXPECT_EQ(g[1 - axis], 0);              // no displacement, no opinion: the guard
    }
  }
}

// The flaw of the printed rule, kept on purpose: each axis is credited with all of the change.
TEST(SecantEstimator, CreditsEachAxisWithTheWholeChange) {
  const Matrix3d R = Matrix3d::Identity();
  const Vector3d step(3e-4, 3e-4, 0), g_true(40, 0, 0);
  const Vector3d g = SecantEstimator::Gradient({0, 0, 0}, 0, step, g_true.dot(step), R, 3e-4);
  EXPECT_NEAR(g.x(), 40, 1e-9);
  EXPECT_NEAR(g.y(), 40, 1e-9);  // where the truth is 0
}

TEST(SecantEstimator, GuardKeepsItFiniteAsADisplacementVanishes) {
  for (const double dx : {0.0, 1e-300, 1e-12, 7.4e-5}) {
    const Vector3d g =
        SecantEstimator::Gradient({0, 0, 0}, 0, {dx, 3e-4, 0}, 1e-2, Matrix3d::Identity(), 3e-4);
    EXPECT_EQ(g.x(), 0) << dx;  // below a quarter of the least displacement
    EXPECT_NEAR(g.y(), 1e-2 / 3e-4, 1e-9);
  }
}

/// Feeds one turn after another of a circle of `radius` [m] about `centre` in the tangent plane.
template <typename Phi>
void FeedCircle(LeastSquaresEstimator* estimator, const Vector3d& centre, const Matrix3d& R_WC,
                double radius, int samples, double keep, Phi phi) {
  for (int k = 0; k < samples; ++k) {
    const double a = 2 * std::numbers::pi * k / 100;
    const Vector3d p = centre + R_WC * Vector3d(radius * std::cos(a), radius * std::sin(a), 0);
    estimator->Add(p, phi(p), keep);
  }
}

TEST(LeastSquaresEstimator, IsExactOnAPlaneWithLinearPhi) {
  RandomStream random(3, 0);
  for (int trial = 0; trial < 100; ++trial) {
    const Matrix3d R_WC = RandomFrame(&random);
    const Vector3d g_C(37, -12, 0), centre = 0.1 * random.Normal3();
    LeastSquaresEstimator estimator;
    FeedCircle(&estimator, centre, R_WC, 5e-4, 500, 0.99,
               [&](const Vector3d& p) { return 1 + (R_WC * g_C).dot(p - centre); });
    // 500 sums of rounding errors of 1e-16 in phi, over displacements of 5e-4 m.
    EXPECT_LT((estimator.Gradient(R_WC, 0) - g_C).norm(), 1e-8);
  }
}

TEST(LeastSquaresEstimator, DoesNotCareAboutTheTangentAxes) {
  RandomStream random(4, 0);
  const Matrix3d R_WC = RandomFrame(&random);
  const Matrix3d turned = R_WC * Eigen::AngleAxisd(0.7, Vector3d::UnitZ()).toRotationMatrix();
  LeastSquaresEstimator estimator;
  for (int k = 0; k < 200; ++k) {
    const Vector3d p = 5e-4 * random.Normal3();
    estimator.Add(p, 20 * p.x() + 0.01 * random.Normal(), 0.99);
  }
  EXPECT_LT(
      (R_WC * estimator.Gradient(R_WC, 2e-8) - turned * estimator.Gradient(turned, 2e-8)).norm(),
      1e-9);  // rounding
}

TEST(LeastSquaresEstimator, RecoversTheGradientUnderNoise) {
  constexpr double kRadius = 5e-4, kKeep = 0.995, kSigma = 2e-3;
  const Vector3d g_true(30, -20, 0);
  const Matrix3d R = Matrix3d::Identity();
  RandomStream random(5, 0);
  // Variance of each component: sigma² times the sum of squared weights over the weighted scatter,
  // with weights keep^k: sigma² (1 - keep) / (1 + keep) / (radius² / 2).
  const double sd = kSigma * std::sqrt((1 - kKeep) / (1 + kKeep) * 2) / kRadius;
  double square = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    LeastSquaresEstimator estimator;
    FeedCircle(&estimator, Vector3d::Zero(), R, kRadius, 2000, kKeep,
               [&](const Vector3d& p) { return g_true.dot(p) + kSigma * random.Normal(); });
    const Vector3d error = estimator.Gradient(R, 0) - g_true;
    EXPECT_LT(error.norm(), 6 * sd);  // two components: 1.5e-8 per trial by chance
    square += error.squaredNorm() / 2;
  }
  // 800 samples of a variance: 5 % of its square root is two standard errors, 10 % four.
  EXPECT_NEAR(std::sqrt(square / kTrials) / sd, 1, 0.1);
}

TEST(LeastSquaresEstimator, OnASphereFindsTheTangentialGradientOfAQuadratic) {
  constexpr double kSphere = 0.025, kCurvature = 6000;  // [m], phi = -k |p - q|² [1/m²]
  RandomStream random(6, 0);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d n = random.Normal3().normalized();
    const Matrix3d R_WC = RotationFromZ(n);
    const Vector3d top = kSphere * (n + 0.1 * TangentPart(random.Normal3(), n)).normalized();
    LeastSquaresEstimator estimator;
    FeedCircle(&estimator, kSphere * n, R_WC, 5e-4, 1000, 0.99, [&](const Vector3d& p) {
      return 1 - kCurvature * (kSphere * p.normalized() - top).squaredNorm();
    });
    const Vector3d g_true = 2 * kCurvature * TangentPart(top - kSphere * n, n);
    // On a whole number of turns the quadratic part is even and cancels; what is left are the
    // weights' unevenness over a turn, half of (1 - 0.99) * 100, on k r = 3 /m.
    EXPECT_LT((R_WC * estimator.Gradient(R_WC, 0) - g_true).norm(), 0.05 * g_true.norm() + 3);
  }
}

TEST(LeastSquaresEstimator, KeepsSilentAboutADirectionItHasNotSeen) {
  LeastSquaresEstimator estimator;
  EXPECT_EQ(estimator.Gradient(Matrix3d::Identity(), 2e-8), Vector3d::Zero());
  for (int k = 0; k < 200; ++k) {
    const double x = 1e-3 * std::sin(0.1 * k);
    estimator.Add({x, 0, 0}, 50 * x, 0.99);
  }
  const Vector3d g = estimator.Gradient(Matrix3d::Identity(), 2e-8);
  EXPECT_EQ(g.y(), 0);
  EXPECT_NEAR(g.x(), 50, 50 * 2e-8 / (0.4e-6));  // the ridge over the variance of the motion
}

TEST(LeastSquaresEstimator, ForgetsTheGradientOfWhereItWas) {
  LeastSquaresEstimator estimator;
  const Matrix3d R = Matrix3d::Identity();
  FeedCircle(&estimator, {0, 0, 0}, R, 5e-4, 1000, 0.98,
             [](const Vector3d& p) { return 40 * p.x(); });
  FeedCircle(&estimator, {0, 0, 0}, R, 5e-4, 1000, 0.98,
             [](const Vector3d& p) { return -40 * p.x(); });
  EXPECT_NEAR(estimator.Gradient(R, 0).x(), -40, 80 * std::pow(0.98, 1000) + 1e-6);
}

}  // namespace
}  // namespace regrasp
