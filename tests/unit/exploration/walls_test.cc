#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/common/random.h"
#include "tests/unit/exploration/sphere_climb.h"

namespace regrasp {
namespace {

// The wall is sensed from one dither's circle before it on, so that it does not come and go.
TEST(SurfaceExploration, AConstrainedMaximumConvergesAndTheWallHolds) {
  const ExplorationParameters parameters = SlowClimb();
  int converged = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomStream random(seed, 7);
    const Vector3d start = StartAt(4e-3, &random);
    Follower finger{start, 0, 0, RandomStream(seed, 8)};
    // A plane half-way to the maximum, at right angles to the way there.
    const Vector3d into = (Top() - start).normalized();
    const double wall_at = into.dot(start) + 2e-3;
    double deepest = -1;
    SurfaceExploration algorithm;
    const Status status = Explore(
        &algorithm, &finger, Estimator::kLeastSquares, seed, 0, parameters,
        [&](SurfaceExploration::Input* input) {
          const double depth = into.dot(input->p_WC) - wall_at;
          if (depth < -WallSlack(parameters)) return;
          const Vector3d direction = TangentPart(into, input->normal_W);
          input->walls.push_back({direction.normalized(), std::max(0.0, depth) / direction.norm()});
        },
        [&] { deepest = std::max(deepest, into.dot(finger.p) - wall_at); });
    converged += status == Status::kConverged;
    EXPECT_LT(deepest, WallSlack(parameters)) << "seed " << seed;
    EXPECT_GT(Phi(finger.p), Phi(start)) << "seed " << seed;
  }
  EXPECT_EQ(converged, 10);
}

// Where the finger starts beyond a wall, it is neither pushed back nor let further in.
TEST(SurfaceExploration, AWallBehindTheStartStandsAtTheStart) {
  const ExplorationParameters parameters = SlowClimb();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomStream random(seed, 7);
    Follower finger{StartAt(4e-3, &random)};
    const Vector3d start = finger.p, into = (Top() - start).normalized();
    constexpr double kBeyond = 2e-3;
    const auto Depth = [&](const Vector3d& p) { return into.dot(p - start) + kBeyond; };
    double deepest = 0;
    SurfaceExploration algorithm;
    const auto Sensed = [&](const Vector3d& p) {
      const Vector3d direction = TangentPart(into, p.normalized());
      return Wall{direction.normalized(), std::max(0.0, Depth(p)) / direction.norm()};
    };
    SurfaceExploration::Input input = finger.Sense();
    input.walls.push_back(Sensed(finger.p));
    algorithm.Start(input, Estimator::kLeastSquares, seed, 0, parameters);
    Status status = Status::kRunning;
    while (status == Status::kRunning) {
      input = finger.Sense();
      if (Depth(finger.p) >= 0) input.walls.push_back(Sensed(finger.p));
      status = algorithm.Update(input, parameters, kDt);
      finger.Move(algorithm.velocity_W());
      deepest = std::max(deepest, Depth(finger.p));
    }
    EXPECT_EQ(status, Status::kConverged) << "seed " << seed;
    EXPECT_LT(deepest, kBeyond + WallSlack(parameters)) << "seed " << seed;
    EXPECT_GT(Depth(finger.p), kBeyond - WallSlack(parameters)) << "seed " << seed;
  }
}

TEST(SurfaceExploration, TwoOpposedWallsLeaveTheFingerBetween) {
  const ExplorationParameters parameters;
  RandomStream random(6, 0);
  Follower finger{StartAt(4e-3, &random)};
  SurfaceExploration algorithm;
  Explore(&algorithm, &finger, Estimator::kLeastSquares, 1, 2000, parameters,
          [](SurfaceExploration::Input* input) {
            const Matrix3d R = RotationFromZ(input->normal_W);
            for (const double sign : {-1.0, 1.0})
              for (const int axis : {0, 1}) input->walls.push_back({sign * R.col(axis), 0});
          });
  EXPECT_TRUE(finger.p.allFinite());
  EXPECT_NEAR(algorithm.gradient_norm(), 0, 1e-9);  // nowhere to go
}

// Behind a blind wall phi tells nothing; here it even leads further in.
TEST(SurfaceExploration, ABlindWallIsLeftFirstWhateverPhiDoes) {
  ExplorationParameters parameters = SlowClimb();
  parameters.speed_min = 0.004;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomStream random(seed, 7);
    Follower finger{StartAt(6e-3, &random)};
    const Vector3d start = finger.p, out = (Top() - start).normalized();
    constexpr double kWay = 2e-3;
    const auto Depth = [&] { return kWay - out.dot(finger.p - start); };
    SurfaceExploration algorithm;
    int blind = 0;
    const auto Sense = [&] {
      SurfaceExploration::Input input = finger.Sense();
      if (Depth() <= 0) return input;
      ++blind;
      input.phi = 10 - 1000 * out.dot(finger.p - start);
      const Vector3d into = TangentPart(-out, input.normal_W);
      input.walls.push_back({into.normalized(), Depth() / into.norm(), Wall::Kind::kBlind});
      return input;
    };
    algorithm.Start(Sense(), Estimator::kLeastSquares, seed, 0, parameters);
    Status status = Status::kRunning;
    while (status == Status::kRunning) {
      const SurfaceExploration::Input input = Sense();
      status = algorithm.Update(input, parameters, kDt);
      if (!input.walls.empty()) {
        const double speed = -algorithm.velocity_W().dot(input.walls[0].direction_W);
        EXPECT_GE(speed, parameters.speed_min - 1e-9) << "seed " << seed;
        EXPECT_LE(speed, parameters.speed_max + 1e-9) << "seed " << seed;
      }
      finger.Move(algorithm.velocity_W());
    }
    EXPECT_EQ(status, Status::kConverged) << "seed " << seed;
    EXPECT_LT(blind, 2 * kWay / parameters.speed_min / kDt) << "seed " << seed;
    EXPECT_GT(Phi(finger.p), Phi(start + kWay * out)) << "seed " << seed;
  }
}

// Where something stands in the way out the search ends once the time is up.
TEST(SurfaceExploration, LeavingABlindWallTakesItsTimeAndNoMore) {
  ExplorationParameters parameters = SlowClimb();
  parameters.onto_tip_s = 0.5;
  RandomStream random(6, 0);
  Follower finger{StartAt(6e-3, &random)};
  const Vector3d start = finger.p;
  SurfaceExploration algorithm;
  const Status status = Explore(&algorithm, &finger, Estimator::kLeastSquares, 1, 2000, parameters,
                                [](SurfaceExploration::Input* input) {
                                  const Vector3d x = RotationFromZ(input->normal_W).col(0);
                                  input->walls.push_back({x, 1e-3, Wall::Kind::kBlind});
                                  input->walls.push_back({-x, 0});
                                });
  EXPECT_EQ(status, Status::kBlind);
  EXPECT_NEAR(algorithm.cycle() * kDt, parameters.onto_tip_s, 2 * kDt);
  EXPECT_LT((finger.p - start).norm(), 1e-9);
}

}  // namespace
}  // namespace regrasp
