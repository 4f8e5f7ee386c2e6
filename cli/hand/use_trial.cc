#include "cli/hand/use_trial.h"

#include <cmath>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "cli/hand/trial.h"
#include "core/session/session.h"

namespace regrasp::hand {
namespace {

constexpr double kLongestExploration = 20, kLongestTurn = 60;  // [s]

/// The job's end; failed where it takes longer. `refused`: whether the command's finger may not
/// leave.
JobRecord Run(Session& session, Command command, double longest_s, bool* refused = nullptr) {
  session.TakeEvents();  // of the past
  command.job = 2;
  session.Apply(command);
  const auto end = session.tick() + std::llround(longest_s / session.config().world.dt);
  while (session.job_running() && session.tick() < end) {
    session.Tick();
    for (const Event& event : session.TakeEvents())
      if (refused != nullptr && event.kind == EventKind::kRefused)
        *refused = event.finger == command.finger;  // the last one is the job's
  }
  JobRecord ended;
  ended.state = JobState::kFailed;
  for (const JobRecord& job : session.TakeFinishedJobs()) ended = job;
  return ended;
}

UseTrial UseOnce(const LoadedScenario& model, Stepper stepper, std::uint64_t seed) {
  UseTrial trial;
  trial.explorations = model.hand.num_fingers();
  trial.turns = 1;
  const Grasped grasped = GraspWith(model, stepper, seed);
  if (!grasped.held()) return trial;
  Session& session = *grasped.session;
  std::string state;
  session.Save(&state);
  for (int f = 0; f < model.hand.num_fingers(); ++f) {
    Command explore;
    explore.type = CommandType::kExplore;
    explore.finger = f;
    explore.seed = seed;
    bool refused = false;
    const JobRecord job = Run(session, explore, kLongestExploration, &refused);
    const ExploreResult& result = job.explore;
    if (session.state() == SessionState::kFaulted) return trial;
    if (grasped.held() && result.phi_true_final > result.phi_true_initial) ++trial.rose;
    if (refused && job.state == JobState::kFailed) ++trial.stayed[static_cast<std::size_t>(f)];
    session.Load(state);
  }
  Command rotate;
  rotate.type = CommandType::kRotate;
  rotate.axis_W = -Vector3d::UnitZ();
  rotate.angle_rad = 2 * M_PI;
  const JobRecord job = Run(session, rotate, kLongestTurn);
  if (job.state != JobState::kDone || job.rotate.dropped) return trial;
  trial.turned = 1;
  if (1e3 * job.rotate.max_position_error_m <= kCleanOffset &&
      job.rotate.max_tilt_rad * 180 / M_PI <= kCleanTilt)
    trial.clean = 1;
  return trial;
}

}  // namespace

UseTrial& UseTrial::operator+=(const UseTrial& more) {
  explorations += more.explorations;
  rose += more.rose;
  for (std::size_t f = 0; f < stayed.size(); ++f) stayed[f] += more.stayed[f];
  turns += more.turns;
  turned += more.turned;
  clean += more.clean;
  return *this;
}

double UseTrial::Points() const {
  const auto share = [](int of, int all) { return all > 0 ? static_cast<double>(of) / all : 0.0; };
  return share(rose, explorations) + share(turned, turns) + share(clean, turns);
}

UseTrial TryToUse(const LoadedScenario& model, Stepper stepper, std::uint64_t seed,
                  unsigned seeds) {
  std::vector<std::future<UseTrial>> trials;
  for (unsigned k = 0; k < seeds; ++k)
    trials.push_back(std::async(std::launch::async, UseOnce, std::cref(model), stepper, seed + k));
  UseTrial all;
  for (auto& trial : trials) all += trial.get();
  return all;
}

}  // namespace regrasp::hand
