#pragma once

/// A smooth objective with one maximum on a sphere, and a finger that climbs it without inertia:
/// what the tests of Algorithm 1 share.

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "core/common/frames.h"
#include "core/common/random.h"
#include "core/exploration/surface_exploration.h"

namespace regrasp {

inline constexpr double kDt = 1e-3;
inline constexpr double kRadius = 0.025;    // of the sphere that is explored [m]
inline constexpr double kCurvature = 3000;  // phi = 1.5 - k |p - top|² [1/m²]: 24 /m at 4 mm
using Status = SurfaceExploration::Status;

inline Vector3d Top() { return kRadius * Vector3d(0.3, -0.5, 0.8).normalized(); }
inline double Phi(const Vector3d& p) { return 1.5 - kCurvature * (p - Top()).squaredNorm(); }

/// A point of the sphere `distance` [m] from the maximum, in some direction.
inline Vector3d StartAt(double distance, RandomStream* random) {
  const Vector3d n = Top().normalized();
  const Vector3d t = TangentPart(random->Normal3(), n).normalized();
  const double angle = distance / kRadius;
  return kRadius * (std::cos(angle) * n + std::sin(angle) * t);
}

/// A finger that follows every commanded velocity at once and stays on the sphere.
struct Follower {
  Vector3d p;
  double phi_noise = 0, position_noise = 0;
  RandomStream random{99, 0};
  SurfaceExploration::Input Sense() {
    SurfaceExploration::Input input;
    input.p_WC = p + position_noise * random.Normal3();
    input.normal_W = p.normalized();
    input.phi = Phi(p) + phi_noise * random.Normal();
    return input;
  }
  void Move(const Vector3d& v) { p = kRadius * (p + v * kDt).normalized(); }
};

/// Runs until the algorithm ends. `walls` may add walls to what is sensed.
inline Status Explore(SurfaceExploration* algorithm, Follower* finger, Estimator estimator,
                      std::uint64_t seed, int max_cycles, const ExplorationParameters& parameters,
                      const std::function<void(SurfaceExploration::Input*)>& walls = {},
                      const std::function<void()>& every_tick = {}) {
  algorithm->Start(finger->Sense(), estimator, seed, max_cycles, parameters);
  for (;;) {
    SurfaceExploration::Input input = finger->Sense();
    if (walls) walls(&input);
    const Status status = algorithm->Update(input, parameters, kDt);
    if (status != Status::kRunning) return status;
    finger->Move(algorithm->velocity_W());
    if (every_tick) every_tick();
  }
}

// What is left of the noise after the filters: 1 % of phi, 0.13 mm of position.
inline constexpr double kPhiNoise = 0.01, kPositionNoise = 1.3e-4;

/// Lines 6 to 8 look back over some 0.8 s (lambda: 10 updates of 50 ms; the window of the least
/// squares). A climb is stable when it is slow against that: 2 k eta * 0.8 s < 1, with no least
/// speed that would carry the finger over the top.
inline ExplorationParameters SlowClimb() {
  ExplorationParameters parameters;
  parameters.lambda = 0.9;
  parameters.eta = 1e-4;
  parameters.speed_min = 0;
  parameters.max_cycles = 30000;
  return parameters;
}

/// Largest way [m] into a wall: the dither's circle, and what the speed limit allows before the
/// wall's return balances it.
inline double WallSlack(const ExplorationParameters& parameters) {
  return 2 * parameters.dither_speed / (2 * std::numbers::pi * parameters.dither_hz) +
         parameters.speed_max * kDt;
}

}  // namespace regrasp
