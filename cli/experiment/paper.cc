#include "cli/experiment/paper.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>

#include "cli/demo/figures.h"
#include "cli/experiment/experiments.h"
#include "cli/experiment/identity.h"
#include "cli/experiment/runner.h"
#include "cli/experiment/summary.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

// The first of the trials' seeds: never used while tuning.
constexpr const char* kFirstSeed = "20000";

std::int64_t Integer(const Invocation& invocation, const char* key, const char* otherwise) {
  return static_cast<std::int64_t>(
      ParseNumber(invocation.Text(key, otherwise), std::string("--") + key));
}

}  // namespace

ExitCode Paper(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const fs::path output = invocation.Text("output");
  const fs::path data = output / "reproduction";
  const std::int64_t seed = Integer(invocation, "seed", kFirstSeed);
  const std::int64_t seeds = Integer(invocation, "seeds", "50");
  const std::int64_t repeats = Integer(invocation, "repeats", "50");
  const double turns = ParseNumber(invocation.Text("turns", "1"), "--turns");
  const int workers = Workers(invocation);
  std::error_code error;
  fs::create_directories(data, error);
  if (error)
    throw CliError(kIo, fmt::format("cannot make {}: {}", data.string(), error.message()),
                   "regrasp experiment paper -o OTHER_DIR");

  const PaperSize size = {.seed = seed,
                          .seeds = seeds,
                          .finger = invocation.Text("finger", "all"),
                          .rays = static_cast<int>(Integer(invocation, "rays", "8")),
                          .turns = turns,
                          .models_dir = invocation.Has("models-dir")
                                            ? fs::absolute(invocation.Text("models-dir")).string()
                                            : ""};
  PaperResults results;
  results.parts = PaperParts(size);
  if (invocation.Has("only-paper"))
    std::erase_if(results.parts, [](const PaperPart& part) { return !part.title.empty(); });
  // Whatever a daemon refuses is found before the first hour has passed.
  for (PaperPart& part : results.parts) CompletePlan(&part.plan);
  std::size_t number = 0;
  for (const PaperPart& part : results.parts) {
    if (!context.options().quiet)
      fmt::print(stderr, "{} ({} of {})\n", part.name, ++number, results.parts.size());
    results.summaries[part.name] = RunExperiment(context, part.plan, workers, data / part.name);
  }

  if (!context.options().quiet) fmt::print(stderr, "figures, {} repetitions\n", repeats);
  std::vector<std::string> arguments = results.parts.front().plan.DaemonArguments();
  arguments.insert(arguments.end(), {"--output-dir", fs::absolute(data).string()});
  SteppedDaemon daemon(arguments);
  CheckIdentity(&daemon, 0, results.parts.front().plan);
  // The page tells the paper's gait.
  daemon.Call("param.set", {{"name", "gait.preset"}, {"value", "paper"}});
  const Json parameters = daemon.Call("param.get");
  for (const Json& parameter : parameters.at("parameters"))
    results.parameters[Plain(parameter.at("name"))] = parameter.at("value");
  daemon.Call("param.set", {{"name", "gait.preset"}, {"value", "planned"}});
  Figures figures(context, &daemon, data, seed, turns);
  figures.Grasp();
  figures.Explorations(static_cast<int>(repeats));
  figures.Rotations();
  results.figures = figures.measured();
  Json measured = results.figures;
  measured.erase("pictures");  // their paths are those of this machine
  WriteFile(data / "figures.json", measured.dump(1) + "\n");
  results.date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  results.command =
      fmt::format("regrasp experiment paper --seed {} -n {} --repeats {} --turns {} -o DIR", seed,
                  seeds, repeats, turns);
  for (const char* flag : {"finger", "rays"})
    if (invocation.Has(flag)) {
      const std::string given = fmt::format(" --{} {}", flag, invocation.Text(flag));
      results.command.insert(results.command.rfind(" -o "), given);
    }
  if (invocation.Has("only-paper"))
    results.command.insert(results.command.rfind(" -o "), " --only-paper");
  results.data = "reproduction";
  results.among_documents =
      fs::exists(output / "experiments.md") && fs::exists(output / "paper_map.md");
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
