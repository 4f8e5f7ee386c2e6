#include "cli/experiment/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "cli/experiment/identity.h"
#include "cli/experiment/runner.h"
#include "cli/experiment/summary.h"
#include "cli/experiment/trial.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {

namespace {

/// The error for a `name` that `flag` does not know; `whole` stands for all names.
CliError NoneOf(const Plan& plan, const char* flag, const std::string& name,
                const std::vector<std::string>& known, const char* whole) {
  const std::string_view nearest = NearestName(name, known);
  return {kUsage,
          fmt::format("{} '{}' is none of {}, {}", flag, name, fmt::join(known, ", "), whole),
          fmt::format("regrasp experiment {} {} {} -o DIR", plan.experiment, flag,
                      nearest.empty() ? whole : nearest)};
}

/// The objects of a zoo by name, and its cases. Throws CliError(kUsage) where one is unknown.
void AddZoo(SteppedDaemon* daemon, Plan* plan) {
  const Json reset = daemon->Call("describe", {{"method", "reset"}}).at("methods").at(0);
  std::vector<std::string> known;
  for (const Json& parameter : reset.at("params"))
    if (parameter.at("name") == "object")
      known = parameter.at("values").get<std::vector<std::string>>();
  if (plan->objects == std::vector<std::string>{kWholeZoo}) {
    plan->objects.clear();
    std::copy_if(known.begin(), known.end(), std::back_inserter(plan->objects),
                 [](const std::string& name) { return name.starts_with("zoo_"); });
  }
  for (const std::string& name : plan->objects)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw NoneOf(*plan, "--objects", name, known, kWholeZoo);
  plan->experiment == "zoo" ? ExpandZoo(plan) : ExpandHazards(plan);
}

}  // namespace

void CompletePlan(Plan* plan) {
  if (!plan->objects.empty() && plan->cases.empty()) {
    SteppedDaemon daemon(plan->DaemonArguments());
    AddZoo(&daemon, plan);
  }
  const auto sweeps = [plan] {
    return std::any_of(plan->common.set.begin(), plan->common.set.end(),
                       [](const auto& item) { return item.second.find(',') != std::string::npos; });
  };
  if (sweeps()) {
    SteppedDaemon daemon(plan->DaemonArguments());
    ExpandSweeps(plan, [&daemon](const std::string& name) {
      return daemon.Call("param.get", {{"name", name}}).at("value").is_array();
    });
  }
  plan->models = plan->parameters = Json::object();
  for (std::size_t i = 1; i < plan->num_cases(); ++i) {
    SteppedDaemon daemon(plan->DaemonArguments(i));
    Prepare(&daemon, *plan, i);
    AddIdentity(&daemon, i, plan);
  }
  SteppedDaemon daemon(plan->DaemonArguments());
  plan->version = Plain(daemon.Call("version").at("version"));
  plan->build = DaemonBuild();
  Prepare(&daemon, *plan);
  AddIdentity(&daemon, 0, plan);
  if (plan->rotation()) return;
  std::vector<std::string> fingers;
  const Json contacts = daemon.Call("contacts");
  for (const auto& [name, finger] : Named(contacts.at("fingers"), "finger"))
    fingers.push_back(name);
  if (plan->subjects == std::vector<std::string>{kEveryFinger}) {
    plan->subjects = fingers;
    return;
  }
  for (const auto& name : plan->subjects)
    if (std::find(fingers.begin(), fingers.end(), name) == fingers.end())
      throw NoneOf(*plan, "--finger", name, fingers, kEveryFinger);
}

Json RunExperiment(Context& context, const Plan& plan, int workers,
                   const std::filesystem::path& directory) {
  Store store(directory, plan);
  try {
    RunPlan(context, plan, workers, &store);
  } catch (const CliError& error) {
    const bool again = error.code != kUsage && error.code != kRefused;
    throw CliError(error.code,
                   fmt::format("{}; {} of {} finished and are kept in {}", error.what(),
                               store.trials().size(), plan.Mine().size(), directory.string()),
                   again ? "the same command again goes on" : error.hint);
  }
  return WriteResults(plan, store.trials(), directory);
}

int Workers(const Invocation& invocation) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return static_cast<int>(
      ParseNumber(invocation.Text("workers", std::to_string(cores)), "--workers"));
}

}  // namespace regrasp::cli
