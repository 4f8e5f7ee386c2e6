/// Times of the quality measures: five contacts on a 25 mm sphere, as in a grasp of the hand.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/common/random.h"
#include "core/quality/epsilon.h"
#include "core/quality/load_margin.h"
#include "core/quality/manipulability.h"
#include "core/quality/stability.h"

namespace regrasp {
namespace {

constexpr double kScale = 0.025;
constexpr int kGrasps = 64;

using Contacts = std::vector<GraspContact>;

/// Grasps of n contacts anywhere on the sphere, or, biased, mostly below it (held, no force
/// closure).
std::vector<Contacts> Grasps(int n, double bias) {
  RandomStream random(1, 0);
  std::vector<Contacts> grasps(kGrasps);
  for (Contacts& contacts : grasps) {
    for (int k = 0; k < n; ++k) {
      const Vector3d p = (random.Normal3() - bias * Vector3d::UnitZ()).normalized();
      contacts.push_back({kScale * p, (-p + 0.1 * random.Normal3()).normalized(), 0.8});
    }
  }
  return grasps;
}

/// Runs f(contacts) over the grasps; reports median and worst time [us] beside the mean.
template <typename Function>
void Measure(benchmark::State& state, const std::vector<Contacts>& grasps, Function f) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  std::size_t i = 0;
  for (auto _ : state) {
    const Clock::time_point start = Clock::now();
    benchmark::DoNotOptimize(f(grasps[i++ % grasps.size()]));
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  state.counters["median_us"] = times[times.size() / 2];
  state.counters["p99_us"] = times[times.size() * 99 / 100];
}

void Manipulability4Joints(benchmark::State& state) {
  FingerJacobian J = FingerJacobian::Random(3, 4);
  for (auto _ : state) {
    benchmark::DoNotOptimize(J.data());
    benchmark::DoNotOptimize(Manipulability(J));
  }
}
BENCHMARK(Manipulability4Joints);

void Singular(benchmark::State& state) {
  Measure(state, Grasps(static_cast<int>(state.range(0)), 0.0), [](const Contacts& contacts) {
    return ComputeSingularMeasures(contacts, kScale).min_singular_value;
  });
}
BENCHMARK(Singular)->Arg(5);

void Margin(benchmark::State& state) {
  const double cap = state.range(1) > 0 ? static_cast<double>(state.range(1)) : 1e30;
  Measure(state, Grasps(static_cast<int>(state.range(0)), 1.0), [cap](const Contacts& contacts) {
    return LoadMargin(contacts, {0, 0, -0.785}, kScale, cap);
  });
}
BENCHMARK(Margin)->ArgNames({"contacts", "cap_n"})->ArgsProduct({{4, 5}, {0, 4}});

void Epsilon(benchmark::State& state) {
  EpsilonSolver solver;
  const int edges = static_cast<int>(state.range(1));
  Measure(state, Grasps(static_cast<int>(state.range(0)), 0.0),
          [&](const Contacts& contacts) { return solver.Compute(contacts, kScale, edges); });
}
BENCHMARK(Epsilon)->ArgNames({"contacts", "edges"})->ArgsProduct({{4, 5, 8}, {8}})->Args({5, 16});

/// The most one tick pays for a spread computation.
void EpsilonStep(benchmark::State& state) {
  EpsilonSolver solver;
  const int budget = static_cast<int>(state.range(0));
  Measure(state, Grasps(5, 0.0), [&](const Contacts& contacts) {
    if (solver.done()) solver.Begin(contacts, kScale, 8);
    return solver.Step(budget);
  });
}
BENCHMARK(EpsilonStep)->ArgName("facets")->Arg(100)->Arg(200);

/// The hardest case found: five contacts at equal angles on a great circle.
void EpsilonRegularPentagon(benchmark::State& state) {
  Contacts contacts;
  for (int k = 0; k < 5; ++k) {
    const Vector3d p(std::cos(2 * M_PI * k / 5), std::sin(2 * M_PI * k / 5), 0);
    contacts.push_back({kScale * p, -p, 0.8});
  }
  EpsilonSolver solver;
  for (auto _ : state) benchmark::DoNotOptimize(solver.Compute(contacts, kScale, 8));
}
BENCHMARK(EpsilonRegularPentagon);

void Volume(benchmark::State& state) {
  Measure(state, Grasps(5, 0.0),
          [](const Contacts& contacts) { return WrenchHullVolume(contacts, kScale, 8); });
}
BENCHMARK(Volume);

}  // namespace
}  // namespace regrasp

BENCHMARK_MAIN();
