#include "daemon/loop/bench.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "core/session/session.h"
#include "daemon/daemon.h"
#include "daemon/wire/json.h"

namespace regrasp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMostGraspTicks = 20000;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Json Quantiles(std::vector<double>& seconds) {
  if (seconds.empty()) return nullptr;
  std::ranges::sort(seconds);
  return {{"median_s", seconds[seconds.size() / 2]}, {"p99_s", seconds[seconds.size() * 99 / 100]}};
}

class Bench {
 public:
  explicit Bench(const SessionConfig& config) : session_(config) { session_.MeasureStages(true); }

  void Give(CommandType type) {
    Command command;
    command.type = type;
    command.job = ++job_;
    command.seed = static_cast<std::uint64_t>(job_);
    session_.Apply(command);
  }
  void Grasp() {
    Give(CommandType::kGrasp);
    for (int i = 0; i < kMostGraspTicks && session_.state() != SessionState::kHolding; ++i) Tick();
  }
  Json Measure(bool exploring, double seconds) {
    std::array<std::vector<double>, 5> times;
    const auto start = Clock::now();
    while (Since(start) < seconds) {
      if (exploring && !session_.job_running()) Give(CommandType::kExplore);
      const auto before = Clock::now();
      Tick();
      times[0].push_back(Since(before));
      const Session::StageTimes stages = session_.stage_times();
      times[1].push_back(stages.sense_s);
      times[2].push_back(stages.control_s);
      times[3].push_back(stages.collide_s);
      times[4].push_back(stages.step_s);
    }
    const auto ticks = static_cast<double>(times[0].size());
    return {{"ticks", times[0].size()},       {"ticks_per_s", ticks / Since(start)},
            {"tick", Quantiles(times[0])},    {"sense", Quantiles(times[1])},
            {"control", Quantiles(times[2])}, {"collide", Quantiles(times[3])},
            {"step", Quantiles(times[4])}};
  }

 private:
  void Tick() {
    session_.Tick();
    session_.TakeEvents();
    session_.TakeFinishedJobs();
  }

  Session session_;
  std::int64_t job_ = 0;
};

}  // namespace

std::string Benchmark(const DaemonConfig& config, double seconds) {
  const SessionConfig session = MakeSessionConfig(config);
  Bench bench(session);
  bench.Grasp();
  Json states;
  states["holding"] = bench.Measure(false, seconds);
  states["exploring"] = bench.Measure(true, seconds);
  return Json({{"hand", session.model.hand.name},
               {"object", session.model.object.name},
               {"stepper", config.stepper},
               {"noise", config.noise},
               {"dt_s", session.world.dt},
               {"states", std::move(states)}})
      .dump();
}

}  // namespace regrasp
