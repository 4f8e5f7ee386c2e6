#include "cli/hand/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/session/session.h"
#include "core/session/start.h"

namespace regrasp::hand {
namespace {

constexpr const char* kDropped = "it dropped the object";

}  // namespace

Grasped GraspWith(const LoadedScenario& model, Stepper stepper, std::uint64_t seed) {
  constexpr double kLongest = 20;  // [s]
  SessionConfig config;
  config.model = model;
  config.parameters = DefaultParameters(model);
  config.noise = NoisePreset("paper").value();
  config.seed = seed;
  config.world.stepper = stepper;
  Grasped grasped{std::make_unique<Session>(config), ""};
  Session& session = *grasped.session;
  Command grasp;
  grasp.type = CommandType::kGrasp;
  grasp.job = 1;
  session.Apply(grasp);
  const auto ticks = std::llround(kLongest / config.world.dt);
  while (session.job_running() && session.tick() < ticks) session.Tick();
  for (const JobRecord& job : session.TakeFinishedJobs()) grasped.end = job.error;
  if (grasped.held()) return grasped;
  if (session.state() == SessionState::kFaulted) grasped.end = session.world().fault_message();
  if (grasped.end.empty()) grasped.end = kDropped;
  return grasped;
}

bool Grasped::held() const { return session->state() == SessionState::kHolding; }

HoldTrial TryToHold(const LoadedScenario& model, Stepper stepper, std::uint64_t seed,
                    double seconds) {
  const Grasped grasped = GraspWith(model, stepper, seed);
  HoldTrial trial;
  trial.end = grasped.end;
  if (!grasped.held()) return trial;
  Session& session = *grasped.session;
  const Vector3d p = session.truth().p_WO;
  for (const auto end = session.tick() + std::llround(seconds / session.config().world.dt);
       session.tick() < end && grasped.held();)
    session.Tick();
  trial.moved_m = (session.truth().p_WO - p).norm();
  const bool slipped = grasped.held() && trial.moved_m > kHeldWithin;
  trial.held = grasped.held() && !slipped;
  trial.seeds = trial.held ? 1 : 0;
  trial.end = trial.held ? ""
              : slipped  ? fmt::format("the object slipped by {:.1f} mm", 1e3 * trial.moved_m)
                         : kDropped;
  Frame frame;
  session.Snapshot(&frame, false);
  const bool none_leaves = model.hand.num_fingers() < kFewestToRegrasp;
  trial.with_all_n = frame.stability.load_margin;
  trial.margin_n = none_leaves ? trial.with_all_n : 1e9;
  for (std::size_t f = 0; f < model.hand.fingers.size(); ++f) {
    const double margin = frame.fingers[f].load_margin_without;
    trial.without_n[f] = std::max(0.0, margin);
    if (!none_leaves) trial.margin_n = std::min(trial.margin_n, margin);
  }
  return trial;
}

std::vector<Start> Starts(const LoadedScenario& model, std::uint64_t seed) {
  const StartParameters spread = DefaultParameters(model).start;
  std::vector<Start> starts;
  for (unsigned k = 0; k < kStarts; ++k) {
    const StartPosture start = MakeStart(model.hand, model.scenario, spread, seed + k);
    starts.push_back({start.q_open, start.X_WO.translation() - model.scenario.X_WO.translation()});
  }
  return starts;
}

void Found::Try(std::uint64_t seed) {
  choice = ChooseStepper(model, {});
  trial = TryToHold(model, choice.stepper, seed, kHold);
  for (int k = 1; k < kTrials && trial.held; ++k) {
    const HoldTrial next = TryToHold(model, choice.stepper, seed + static_cast<unsigned>(k), kHold);
    trial.held = next.held;
    trial.end = next.end;
    trial.moved_m = std::max(trial.moved_m, next.moved_m);
    trial.margin_n = std::min(trial.margin_n, next.margin_n);
    trial.seeds += next.seeds;
    trial.with_all_n = std::min(trial.with_all_n, next.with_all_n);
    for (std::size_t f = 0; f < trial.without_n.size(); ++f)
      trial.without_n[f] = std::min(trial.without_n[f], next.without_n[f]);
  }
}

bool Found::Better(const Found& other) const {
  if (!any() || !other.any()) return any();
  const auto rank = [](const Found& f) {
    return std::tuple(f.Good(), f.trial.held, -f.inside, f.trial.seeds, f.use.Points(),
                      f.trial.held ? f.trial.margin_n : 0.0);
  };
  return rank(*this) > rank(other);
}

}  // namespace regrasp::hand
