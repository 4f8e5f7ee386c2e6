#include "cli/experiment/paper.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>

#include "cli/experiment/experiments.h"
#include "cli/experiment/runner.h"
#include "cli/experiment/summary.h"
#include "cli/figures.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kSweepShare = 5;  // the sweep and the rotations take so many times fewer seeds

std::int64_t Integer(const Invocation& invocation, const char* key, const char* otherwise) {
  return static_cast<std::int64_t>(
      ParseNumber(invocation.Text(key, otherwise), std::string("--") + key));
}

/// Runs what is left of one part and writes its results.
Json Part(Context& context, Plan plan, int workers, const fs::path& directory,
          const std::string& title) {
  if (!context.options().quiet) fmt::print(stderr, "{}\n", title);
  CompletePlan(&plan);
  return RunExperiment(context, plan, workers, directory);
}

}  // namespace

ExitCode Paper(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const fs::path output = invocation.Text("output");
  const fs::path data = output / "reproduction";
  const std::int64_t seed = Integer(invocation, "seed", "1");
  const std::int64_t seeds = Integer(invocation, "seeds", "50");
  const std::int64_t few = std::max<std::int64_t>(1, seeds / kSweepShare);
  const std::int64_t repeats = Integer(invocation, "repeats", "50");
  const double turns = ParseNumber(invocation.Text("turns", "1"), "--turns");
  const int workers = Workers(invocation);
  std::error_code error;
  fs::create_directories(data, error);
  if (error)
    throw CliError(kIo, fmt::format("cannot make {}: {}", data.string(), error.message()),
                   "regrasp experiment paper -o OTHER_DIR");

  Plan common;
  if (invocation.Has("models-dir"))
    common.models_dir = fs::absolute(invocation.Text("models-dir")).string();
  common.noise = {"paper"};
  common.first_seed = seed;
  PaperResults results;

  Plan plan = common;
  plan.experiment = "exploration";
  plan.subjects = {invocation.Text("finger", "all")};
  plan.criterion = "manipulability";
  plan.estimators = {"least_squares", "secant"};
  plan.rays = static_cast<int>(Integer(invocation, "rays", "12"));
  plan.seeds = seeds;
  results.exploration = Part(context, plan, workers, data / "exploration",
                             fmt::format("explorations, {} seeds", seeds));
  plan.experiment = "noise-sweep";
  plan.noise = {"off", "fine", "paper", "coarse", "taxel"};
  plan.seeds = few;
  results.sweep =
      Part(context, plan, workers, data / "sweep", fmt::format("noise sweep, {} seeds", few));
  plan = common;
  plan.experiment = "rotation";
  plan.subjects = {"0,0,-1"};
  plan.turns = turns;
  plan.seeds = few;
  plan.set = {{"gait.mode", "1"}};
  results.returning = Part(context, plan, workers, data / "returning",
                           fmt::format("rotations, returning, {} seeds", few));
  plan.set = {{"gait.mode", "0"}};
  results.exploring = Part(context, plan, workers, data / "exploring",
                           fmt::format("rotations, exploring, {} seeds", few));

  if (!context.options().quiet) fmt::print(stderr, "figures, {} repetitions\n", repeats);
  std::vector<std::string> arguments = common.DaemonArguments();
  arguments.insert(arguments.end(), {"--output-dir", fs::absolute(data).string()});
  SteppedDaemon daemon(arguments);
  Figures figures(context, &daemon, data, seed, turns);
  figures.Grasp();
  figures.Explorations(static_cast<int>(repeats));
  figures.Rotations();
  results.figures = figures.measured();
  results.date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  results.command =
      fmt::format("regrasp experiment paper --seed {} -n {} --repeats {} --turns {} -o DIR", seed,
                  seeds, repeats, turns);
  results.data = "reproduction";
  const fs::path page = output / "reproduction.md";
  WriteFile(page, ReproductionPage(results));

  const Json answer = {{"page", fs::absolute(page).string()},
                       {"data_dir", fs::absolute(data).string()},
                       {"seed", seed},
                       {"seeds", seeds},
                       {"held", figures.held()}};
  context.Print(answer, [&] {
    context.out().Line("page     " + page.string());
    context.out().Line("figures and trials in " + data.string());
  });
  return kOk;
}

}  // namespace regrasp::cli
