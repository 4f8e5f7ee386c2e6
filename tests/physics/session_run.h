#pragma once

/// A session driven by a test: commands with job ids, ticks until something happens, everything
/// that happened kept.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "core/session/session.h"

namespace regrasp {

inline SessionConfig ShadowConfig(std::uint64_t seed = 1, const std::string& noise = "paper",
                                  const std::string& object = "sphere") {
  SessionConfig config;
  config.model = LoadScenario("shadow", object, ModelSearchPath());
  config.parameters = DefaultParameters(config.model);
  config.noise = NoisePreset(noise).value();
  config.seed = seed;
  return config;
}

class SessionRun {
 public:
  explicit SessionRun(SessionConfig config) : session(std::move(config)) {}
  explicit SessionRun(std::uint64_t seed = 1) : SessionRun(ShadowConfig(seed)) {}

  Verdict Give(CommandType type, const std::function<void(Command*)>& fill = {}) {
    Command command;
    command.type = type;
    command.job = ++last_job;
    if (fill) fill(&command);
    const Verdict verdict = session.Apply(command);
    Collect();
    return verdict;
  }
  Verdict Explore(int finger, std::uint64_t seed = 1, int max_cycles = 0) {
    return Give(CommandType::kExplore, [&](Command* c) {
      c->finger = finger;
      c->seed = seed;
      c->max_cycles = max_cycles;
    });
  }
  Verdict Set(const char* parameter, const Vector3d& value) {
    const int index = FindParameter(parameter);
    EXPECT_GE(index, 0) << parameter;
    return Give(CommandType::kParameter, [&](Command* c) {
      c->parameter = index;
      c->value = value;
    });
  }
  Verdict Set(const char* parameter, double value) { return Set(parameter, Vector3d(value, 0, 0)); }
  Verdict Push(const Vector3d& force, double seconds) {
    return Give(CommandType::kPush, [&](Command* c) {
      c->force_W = force;
      c->duration_s = seconds;
    });
  }

  void Tick() {
    session.Tick();
    Collect();
  }
  void Ticks(int n) {
    for (int k = 0; k < n; ++k) Tick();
  }
  /// Ticks until no job runs, at most `max_s`; false when it still runs.
  bool FinishJob(double max_s = 30) {
    const auto limit = session.tick() + static_cast<std::int64_t>(max_s * 1000);
    while (session.job_running() && session.tick() < limit) Tick();
    return !session.job_running();
  }
  /// Grasps; true when it holds.
  bool Grasp() {
    return Give(CommandType::kGrasp).kind == Verdict::Kind::kAllowed && FinishJob() &&
           session.state() == SessionState::kHolding;
  }
  /// The record of the job given last; id 0 when it has not ended.
  JobRecord Job() const {
    for (const JobRecord& job : jobs)
      if (job.id == last_job) return job;
    return {};
  }
  int Count(EventKind kind) const {
    int n = 0;
    for (const Event& event : events) n += event.kind == kind;
    return n;
  }
  Frame Snapshot() const {
    Frame frame;
    session.Snapshot(&frame, false);
    return frame;
  }

  Session session;
  std::int64_t last_job = 0;
  std::vector<Event> events;
  std::vector<JobRecord> jobs;

 private:
  void Collect() {
    for (const Event& event : session.TakeEvents()) events.push_back(event);
    for (const JobRecord& job : session.TakeFinishedJobs()) jobs.push_back(job);
  }
};

/// How far `seconds` of holding move the object from where it is now, at most [m].
inline double Wander(SessionRun* run, double seconds) {
  const Vector3d p0 = run->session.truth().p_WO;
  double worst = 0;
  for (int k = 0; k < seconds * 1000; ++k) {
    run->Tick();
    worst = std::max(worst, (run->session.truth().p_WO - p0).norm());
  }
  return worst;
}

}  // namespace regrasp
