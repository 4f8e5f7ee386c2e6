#include "cli/experiment/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "cli/experiment/runner.h"
#include "cli/experiment/summary.h"
#include "cli/experiment/trial.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {

void CompletePlan(Plan* plan) {
  for (std::size_t i = 1; i < plan->num_cases(); ++i) {
    SteppedDaemon daemon(plan->DaemonArguments(i));
    Prepare(&daemon, *plan, i);
  }
  SteppedDaemon daemon(plan->DaemonArguments());
  plan->version = Plain(daemon.Call("version").at("version"));
  plan->build = DaemonBuild();
  Prepare(&daemon, *plan);
  if (plan->rotation()) return;
  std::vector<std::string> fingers;
  const Json contacts = daemon.Call("contacts");
  for (const auto& [name, finger] : Named(contacts.at("fingers"), "finger"))
    fingers.push_back(name);
  if (plan->subjects == std::vector<std::string>{"all"}) {
    plan->subjects = fingers;
    return;
  }
  for (const auto& name : plan->subjects) {
    if (std::find(fingers.begin(), fingers.end(), name) != fingers.end()) continue;
    const auto nearest = NearestName(name, fingers);
    throw CliError(kUsage,
                   fmt::format("--finger '{}' is none of {}, all", name, fmt::join(fingers, ", ")),
                   fmt::format("regrasp experiment {} --finger {} -o DIR", plan->experiment,
                               nearest.empty() ? "all" : nearest));
  }
}

Json RunExperiment(Context& context, const Plan& plan, int workers,
                   const std::filesystem::path& directory) {
  Store store(directory, plan);
  try {
    RunPlan(context, plan, workers, &store);
  } catch (const CliError& error) {
    throw CliError(error.code,
                   fmt::format("{}; {} of {} finished and are kept in {}", error.what(),
                               store.trials().size(), plan.Mine().size(), directory.string()),
                   "the same command again goes on");
  }
  return WriteResults(plan, store.trials(), directory);
}

int Workers(const Invocation& invocation) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return static_cast<int>(
      ParseNumber(invocation.Text("workers", std::to_string(cores)), "--workers"));
}

}  // namespace regrasp::cli
