#include "core/exploration/surface_exploration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/common/fields.h"
#include "core/common/random.h"
#include "tests/unit/exploration/sphere_climb.h"

namespace regrasp {
namespace {

struct Outcome {
  int rose = 0, converged = 0, best_rose = 0;
  double worst_distance = 0;
};

/// Fifty starts 4 mm from the maximum. `best_rose` counts the runs whose best point is at least
/// half of the way up.
Outcome FiftySeeds(const char* name, Estimator estimator, const ExplorationParameters& parameters,
                   double phi_noise, double position_noise) {
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    RandomStream random(seed, 7);
    Follower finger{StartAt(4e-3, &random), phi_noise, position_noise, RandomStream(seed, 8)};
    const double before = Phi(finger.p);
    double best = before;
    SurfaceExploration algorithm;
    const Status status = Explore(&algorithm, &finger, estimator, seed, 0, parameters, {},
                                  [&] { best = std::max(best, Phi(finger.p)); });
    outcome.rose += Phi(finger.p) > before;
    outcome.converged += status == Status::kConverged;
    outcome.best_rose += best > 0.5 * (before + Phi(Top()));
    outcome.worst_distance = std::max(outcome.worst_distance, (finger.p - Top()).norm());
  }
  std::printf(
      "%-32s rose %d/50, converged %d/50, best point half-way up %d/50, worst end %.1f mm\n", name,
      outcome.rose, outcome.converged, outcome.best_rose, 1e3 * outcome.worst_distance);
  return outcome;
}

TEST(SurfaceExploration, ConvergesFromFiftySeeds) {
  const ExplorationParameters slow = SlowClimb();
  const Outcome clean = FiftySeeds("least squares, slow", Estimator::kLeastSquares, slow, 0, 0);
  EXPECT_EQ(clean.rose, 50);
  EXPECT_EQ(clean.converged, 50);
  // Where line 3 lets them stop, epsilon / 2 k = 0.7 mm, the dither's circle of 0.5 mm, and the way
  // that a gradient 0.8 s old is behind.
  EXPECT_LT(clean.worst_distance, 2e-3);
  const Outcome noisy = FiftySeeds("least squares, slow, noisy", Estimator::kLeastSquares, slow,
                                   kPhiNoise, kPositionNoise);
  EXPECT_EQ(noisy.rose, 50);
  EXPECT_EQ(noisy.converged, 50);
}

// With the product's parameters, in a hurry and with a least speed, a finger may circle the maximum
// until its time is up; what FingerExploration returns to is the best point it met.
TEST(SurfaceExploration, MeetsAHigherPointFromFiftySeeds) {
  const ExplorationParameters parameters;
  const Outcome clean = FiftySeeds("least squares", Estimator::kLeastSquares, parameters, 0, 0);
  const Outcome noisy = FiftySeeds("least squares, noisy", Estimator::kLeastSquares, parameters,
                                   kPhiNoise, kPositionNoise);
  EXPECT_EQ(clean.best_rose, 50);
  EXPECT_EQ(noisy.best_rose, 50);
}

// The printed rule is kept for comparison: how often it works is reported. Required is only that
// without noise it works more often than chance.
TEST(SurfaceExploration, PrintedRuleClimbsMoreOftenThanNot) {
  const Outcome clean = FiftySeeds("secant", Estimator::kSecant, ExplorationParameters(), 0, 0);
  const Outcome noisy = FiftySeeds("secant, noisy", Estimator::kSecant, ExplorationParameters(),
                                   kPhiNoise, kPositionNoise);
  EXPECT_GE(clean.best_rose, 35);  // of 50; chance reaches 36 once in a thousand
  RecordProperty("clean_rose", clean.rose);
  RecordProperty("noisy_rose", noisy.rose);
}

TEST(SurfaceExploration, VelocityIsTangentialAndWithinItsLimits) {
  const ExplorationParameters parameters;
  for (const EstimatorInfo& row : kEstimatorTable) {
    const Estimator estimator = row.id;
    RandomStream random(1, 0);
    Follower finger{StartAt(4e-3, &random), 0.01, 1e-4};
    SurfaceExploration algorithm;
    const double dither = row.dithers ? parameters.dither_speed : 0;
    Explore(&algorithm, &finger, estimator, 3, 4000, parameters, {}, [&] {
      const double speed = algorithm.velocity_W().norm();
      ASSERT_LE(speed, parameters.speed_max + dither + 1e-12);
      // The normal turns by v dt / radius within the tick in which the finger moves.
      ASSERT_LE(std::abs(algorithm.velocity_W().dot(finger.p.normalized())),
                speed * speed * kDt / kRadius + 1e-12);
      if (dither == 0 && algorithm.gradient_norm() > 1e-6 && speed > 0) {
        ASSERT_GE(speed, parameters.speed_min - 1e-12);
      }
    });
  }
}

TEST(SurfaceExploration, GradientIsCapped) {
  ExplorationParameters parameters;
  parameters.epsilon = 0;  // never converges
  for (const EstimatorInfo& row : kEstimatorTable) {
    const Estimator estimator = row.id;
    RandomStream random(2, 0);
    Follower finger{StartAt(4e-3, &random)};
    SurfaceExploration algorithm;
    algorithm.Start(finger.Sense(), estimator, 1, 3000, parameters);
    double largest = 0;
    for (int k = 0; k < 3000; ++k) {
      SurfaceExploration::Input input = finger.Sense();
      input.phi *= 1e6;  // far steeper than the cap
      if (algorithm.Update(input, parameters, kDt) != Status::kRunning) break;
      finger.Move(algorithm.velocity_W());
      largest = std::max(largest, algorithm.gradient_W().norm());
    }
    EXPECT_LE(largest, parameters.gradient_max + 1e-9);
    EXPECT_GT(largest, 0.5 * parameters.gradient_max);  // the cap was met, not avoided
  }
}

TEST(SurfaceExploration, StopsAfterMaxCycles) {
  ExplorationParameters parameters;
  parameters.epsilon = 0;
  for (const EstimatorInfo& row : kEstimatorTable) {
    const Estimator estimator = row.id;
    RandomStream random(3, 0);
    Follower finger{StartAt(4e-3, &random)};
    SurfaceExploration algorithm;
    int ticks = 0;
    EXPECT_EQ(Explore(&algorithm, &finger, estimator, 1, 777, parameters, {}, [&] { ++ticks; }),
              Status::kMaxCycles);
    EXPECT_EQ(ticks, 777);
    EXPECT_EQ(algorithm.cycle(), 777);
    parameters.max_cycles = 555;
    ticks = 0;
    EXPECT_EQ(Explore(&algorithm, &finger, estimator, 1, 0, parameters, {}, [&] { ++ticks; }),
              Status::kMaxCycles);
    EXPECT_EQ(ticks, 555);
  }
}

TEST(SurfaceExploration, StaysWithinItsExcursion) {
  ExplorationParameters parameters;
  parameters.max_excursion = 2e-3;
  for (const EstimatorInfo& row : kEstimatorTable) {
    const Estimator estimator = row.id;
    RandomStream random(4, 0);
    const Vector3d start = StartAt(6e-3, &random);
    Follower finger{start};
    double farthest = 0;
    SurfaceExploration algorithm;
    Explore(&algorithm, &finger, estimator, 5, 0, parameters, {},
            [&] { farthest = std::max(farthest, (finger.p - start).norm()); });
    // Beyond the bound nothing pulls back, and the finger slides on along the tangent while the
    // dither keeps it outside: another circle's worth.
    EXPECT_LT(farthest, parameters.max_excursion + 2 * WallSlack(parameters)) << Name(estimator);
  }
}

std::vector<Vector3d> Path(std::uint64_t seed, Estimator estimator) {
  RandomStream random(8, 0);
  Follower finger{StartAt(4e-3, &random), 0.01, 1e-4};
  std::vector<Vector3d> path;
  SurfaceExploration algorithm;
  Explore(&algorithm, &finger, estimator, seed, 2000, ExplorationParameters(), {},
          [&] { path.push_back(finger.p); });
  return path;
}

TEST(SurfaceExploration, SameSeedSamePathOtherSeedOtherStart) {
  for (const EstimatorInfo& row : kEstimatorTable) {
    const Estimator estimator = row.id;
    const auto one = Path(1, estimator), again = Path(1, estimator), other = Path(2, estimator);
    ASSERT_EQ(one.size(), again.size());
    for (std::size_t k = 0; k < one.size(); ++k) ASSERT_EQ(one[k], again[k]);
    EXPECT_NE(one[0], other[0]);
  }
  // Line 2 knows no preferred direction: over many seeds the start gradients cancel.
  Vector3d sum = Vector3d::Zero();
  double norms = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SurfaceExploration algorithm;
    SurfaceExploration::Input input;
    algorithm.Start(input, Estimator::kLeastSquares, seed, 0, ExplorationParameters());
    EXPECT_NEAR(algorithm.gradient_W().dot(input.normal_W), 0, 1e-12);
    sum += algorithm.gradient_W();
    norms += algorithm.gradient_W().norm();
  }
  EXPECT_LT(sum.norm() / norms, 0.2);  // a mean of 400 random directions: 0.05 typical
}

TEST(SurfaceExploration, HashFollowsTheState) {
  const auto Digest = [](const SurfaceExploration& algorithm) {
    StateHasher hasher;
    HashFields(algorithm, &hasher);
    return hasher.Digest();
  };
  const ExplorationParameters parameters;
  RandomStream random(9, 0);
  Follower finger{StartAt(4e-3, &random)};
  SurfaceExploration one, two;
  one.Start(finger.Sense(), Estimator::kLeastSquares, 1, 0, parameters);
  two.Start(finger.Sense(), Estimator::kLeastSquares, 1, 0, parameters);
  EXPECT_EQ(Digest(one), Digest(two));
  one.Update(finger.Sense(), parameters, kDt);
  EXPECT_NE(Digest(one), Digest(two));
  two.Update(finger.Sense(), parameters, kDt);
  EXPECT_EQ(Digest(one), Digest(two));
}

}  // namespace
}  // namespace regrasp
