// Experiments: many trials with other seeds, on private daemons, and what they say together.

#include <fmt/format.h>

#include <filesystem>
#include <numbers>
#include <sstream>
#include <utility>

#include "cli/client/context.h"
#include "cli/experiment/experiments.h"
#include "cli/experiment/paper.h"
#include "cli/experiment/summary.h"
#include "cli/experiment/tables.h"
#include "cli/grammar/ranges.h"
#include "cli/grammar/units.h"
#include "core/protocol/start_words.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGroup = "Results";
constexpr double kMostSeeds = 1e6;

double PrintedWidth(const std::string& size) {
  const double width_mm = ParseQuantity(size, "--size", "mm");
  if (width_mm < 50 || width_mm > 1000)
    throw CliError(kUsage, fmt::format("--size {}: allowed are 50 to 1000 mm", size));
  return width_mm;
}

/// What `--format text` shows, and the tables alone as a paper takes them.
void Print(Context& context, const Invocation& invocation, const Json& summary,
           const fs::path& directory) {
  const TableFormat format = TableFormatOf(invocation.Text("format", "text"));
  std::vector<TableData> tables = {GroupTable(summary)};
  if (summary.contains("prediction")) tables.push_back(PredictionTable(summary));
  if (summary.contains("comparisons")) tables.push_back(ComparisonTable(summary));
  if (invocation.Has("precision"))
    tables.push_back(
        SampleSizeTable(summary, ParseNumber(invocation.Text("precision"), "--precision")));
  Json answer = summary;
  answer["output_dir"] = fs::absolute(directory).string();
  fs::path figure;
  if (invocation.Has("size"))
    figure = DrawForPaper(directory, PrintedWidth(invocation.Text("size")));
  std::vector<Json> rows(summary.at("groups").begin(), summary.at("groups").end());
  context.PrintRows(answer, rows, [&] {
    Output& out = context.out();
    for (const TableData& table : tables) {
      if (&table != &tables.front()) out.Line();
      out.Add(Render(out, table, format));
    }
    if (const std::string note = LeftOut(summary); !note.empty()) out.Add(Note(out, note, format));
    if (format != TableFormat::kText) return;
    out.Line();
    out.Line("trials   " + (directory / "trials.csv").string());
    out.Line("summary  " + (directory / "summary.json").string());
    out.Line("picture  " + (directory / "summary.png").string());
    if (!figure.empty()) out.Line("figure   " + figure.string());
  });
}

ExitCode Experiment(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const std::string name = invocation.command->words.substr(std::string("experiment ").size());
  if (invocation.Has("size")) PrintedWidth(invocation.Text("size"));  // refused before hours
  Plan plan = PlanFromArguments(name, invocation);
  CompletePlan(&plan);
  const fs::path directory = invocation.Text("output");
  Print(context, invocation, RunExperiment(context, plan, Workers(invocation), directory),
        directory);
  return kOk;
}

ExitCode Merge(Context& context, const Invocation& invocation) {
  std::vector<fs::path> parts;
  std::istringstream words(invocation.Text("dir"));
  for (std::string word; std::getline(words, word);) parts.emplace_back(word);
  const fs::path directory = invocation.Text("output");
  Plan whole = ReadPlan(parts.front());
  Trials trials;
  for (const auto& part : parts) {
    const Plan plan = ReadPlan(part);
    if (const auto difference = Difference(whole, plan); !difference.empty())
      throw CliError(kRefused,
                     fmt::format("{} holds another experiment than {}: {}", part.string(),
                                 parts.front().string(), difference),
                     "regrasp help experiment merge");
    for (const auto& [unit, result] : ReadTrials(part, plan)) {
      const auto [place, fresh] = trials.emplace(unit, result);
      if (!fresh && !(place->second == result))
        throw CliError(
            kRefused,
            fmt::format("{} has another result for trial {} than the others", part.string(), unit),
            "delete one of the two directories and run it again");
    }
  }
  whole.shard = whole.shards = 1;
  if (trials.size() < whole.num_units())
    throw CliError(kRefused,
                   fmt::format("{} of {} trials are missing", whole.num_units() - trials.size(),
                               whole.num_units()),
                   "give the directory of every shard, each run to its end");
  Store store(directory, whole);
  for (const auto& [unit, result] : trials)
    if (!store.trials().contains(unit)) store.Add(unit, result);
  Print(context, invocation, WriteResults(whole, store.trials(), directory), directory);
  return kOk;
}

Arg Number(const char* key, const char* flags, ArgKind kind, const char* metavar, const char* help,
           double min, double max, const char* default_text) {
  return {.key = key,
          .flags = flags,
          .metavar = metavar,
          .kind = kind,
          .help = help,
          .min = min,
          .max = max,
          .default_text = default_text};
}

constexpr double kDegree = std::numbers::pi / 180;

/// A number with a range of the wire.
Arg AsOnWire(const char* key, const char* metavar, const char* help,
             std::pair<double, double> range, const char* default_text) {
  const std::string flags = std::string("--") + key;
  return Number(key, flags.c_str(), ArgKind::kNumber, metavar, help, range.first, range.second,
                default_text);
}

Arg Turns() { return AsOnWire("turns", "N", "turns, signed", RangeOnWire("rotate", "turns"), "1"); }
Arg Angle() {
  return AsOnWire("angle", "DEG", "instead of turns", RangeOnWire("rotate", "angle_rad", kDegree),
                  "not used");
}
Arg Speed() {
  return AsOnWire("speed", "DEG_S", "speed of the object while it moves",
                  RangeOnWire("rotate", "speed_rad_s", kDegree), "parameter gait.speed_rad_s");
}
Arg Push() {
  Arg push = AsOnWire("push", "N", "push the object each second, for 0.1 s, in a random direction",
                      {0, RangeOnWire("push", "force_n").second}, "0");
  push.unit = "N";
  return push;
}

Arg TableFormatArg() {
  Arg arg = TextArg("format", "--format", "NAME", "tables as text, markdown or latex", "text");
  arg.values = {"text", "markdown", "latex"};
  return arg;
}

Arg PrintedSizeArg() {
  return TextArg("size", "--size", "MM",
                 "also summary.pdf of this printed width, its text at least 7 pt", "no figure");
}

Arg OutputDirectory() {
  Arg arg =
      TextArg("output", "-o,--output", "DIR", "where results go; unfinished ones go on from there");
  arg.required = true;
  return arg;
}

std::vector<Arg> With(std::vector<Arg> args, const char* seeds, const char* noise) {
  Arg set = TextArg(
      "set", "--set", "NAME=VALUE",
      "a parameter of the daemon, as in param set; values with commas are compared; repeatable");
  set.repeated = true;
  Arg cases =
      TextArg("case", "--case", "'NAME: KEY=VALUE ...'",
              "settings to compare: object, tilt, push, turns, criterion, parameters; repeatable");
  cases.repeated = true;
  Arg stepper = TextArg("stepper", "--stepper", "NAME",
                        "fast; exact: the slow reference; round: friction cone", "fast");
  stepper.values.assign(kSteppers.begin(), kSteppers.end());
  for (const Arg& arg :
       {TextArg("noise", "--noise", "NAMES", "presets of sensor noise, separated by commas", noise),
        Number("seed", "--seed", ArgKind::kInteger, "N", "seed of the first trial", 0,
               kMaxSafeInteger - kMostSeeds, "1"),
        Number("seeds", "-n,--seeds", ArgKind::kInteger, "N", "seeds, one after the other", 1,
               kMostSeeds, seeds),
        TextArg("object", "--object", "NAME|FILE", "the object", "the scenario's"),
        Number("tilt", "--tilt", ArgKind::kNumber, "DEG",
               "tilt of the hand: 0 palm up, 90 fingers down", -kMostTilt_deg, kMostTilt_deg,
               "the scenario's"),
        TextArg("hand", "--hand", "NAME|FILE", "the hand", "shadow"), set, cases, stepper,
        TextArg("models-dir", "--models-dir", "DIR", "where models are looked for first"),
        Number("workers", "--workers", ArgKind::kInteger, "N",
               "daemons at work; the results do not depend on it", 1, 256, "one per core"),
        TextArg("shard", "--shard", "i/N", "only every N-th trial, from the i-th; join with merge"),
        TableFormatArg(),
        Number("precision", "--precision", ArgKind::kNumber, "P",
               "how many seeds make intervals of +-P: of shares absolute, of all else relative",
               0.001, 0.49, "not told"),
        PrintedSizeArg(), OutputDirectory()})
    args.push_back(arg);
  return args;
}

/// A zoo's cases are its objects.
std::vector<Arg> WithoutObject(std::vector<Arg> args) {
  std::erase_if(args, [](const Arg& arg) { return arg.key == "object" || arg.key == "case"; });
  return args;
}

/// `every_estimator`: all are compared unless some are named.
std::vector<Arg> ExplorationArgs(bool every_estimator) {
  const ParamSpec& estimator = *FindParam(*FindMethod("explore"), "estimator");
  Arg criterion =
      TextArg("criterion", "--criterion", "NAME", "what is maximised", "manipulability");
  const auto& values = FindParam(*FindMethod("explore"), "criterion")->values;
  criterion.values.assign(values.begin(), values.end());
  return {TextArg("finger", "--finger", "NAMES", "fingers, separated by commas, or all", "all"),
          criterion,
          TextArg("estimator", "--estimator", "NAMES",
                  fmt::format("{}, or several with commas", fmt::join(estimator.values, ", ")),
                  every_estimator ? fmt::format("{}", fmt::join(estimator.values, ","))
                                  : std::string(estimator.default_text)),
          Number("rays", "--rays", ArgKind::kInteger, "N",
                 "rays of the noise-free map that success is judged by; 0: none", 0, 360, "12")};
}

}  // namespace

std::vector<CommandSpec> ExperimentCommands() {
  Arg directories = TextArg("dir", "", "DIR...", "directories of the shards");
  directories.required = directories.repeated = true;
  Arg only_paper = TextArg("only-paper", "--only-paper", "",
                           "leave out what goes beyond the paper, and the ablations");
  only_paper.kind = ArgKind::kFlag;
  return {
      {"experiment exploration", kGroup,
       "explore with many seeds; how often phi rose, and came near the best within reach", nullptr,
       With(ExplorationArgs(false), "50", "paper"), Experiment},
      {"experiment rotation", kGroup, "turn the object with many seeds", nullptr,
       With({TextArg("axis", "--axis", "X,Y,Z", "direction in W; all: six; write --axis=-1,0,0",
                     "0,0,-1"),
             Turns(), Angle(), Speed(), Push()},
            "10", "paper"),
       Experiment},
      {"experiment zoo", kGroup,
       "turn many objects by several gaits, paired; which does better on which", nullptr,
       WithoutObject(With(
           {TextArg("objects", "--objects", "NAMES", "separated by commas; zoo: all of it", "zoo"),
            TextArg(
                "gaits", "--gaits", "NAMES",
                "planned, returning (to the first contact), exploring (the paper's); the first is "
                "what "
                "others are compared with",
                "planned,returning"),
            TextArg("axis", "--axis", "X,Y,Z", "direction in W; write --axis=-1,0,0", "0,0,-1"),
            Turns(), Speed(), Push()},
           "5", "paper")),
       Experiment},
      {"experiment prediction", kGroup,
       "which measure of a running gait foretells a drop or slip, 0.2 to 1 s ahead", nullptr,
       WithoutObject(With(
           {TextArg("objects", "--objects", "NAMES",
                    "separated by commas, each as it is, pushed and slippery; zoo: all of it",
                    "twelve bodies of all kinds"),
            TextArg("axis", "--axis", "X,Y,Z", "direction in W; write --axis=-1,0,0", "0,0,-1"),
            Turns()},
           "2", "paper,coarse")),
       Experiment},
      {"experiment noise-sweep", kGroup,
       "explorations at every noise preset, the estimators side by side", nullptr,
       With(ExplorationArgs(true), "20", "off,fine,paper,coarse,taxel"), Experiment},
      {"experiment paper",
       kGroup,
       "everything the paper shows, measured again: figures, trials and a page",
       nullptr,
       {Number("seed", "--seed", ArgKind::kInteger, "N", "first seed", 0,
               kMaxSafeInteger - kMostSeeds, "20000"),
        Number("seeds", "-n,--seeds", ArgKind::kInteger, "N",
               "seeds of the explorations; all other parts take a fifth of them", 1, kMostSeeds,
               "50"),
        Number("repeats", "--repeats", ArgKind::kInteger, "N",
               "explorations of the ring finger with other start gradients", 0, 1000,
               "50, as in the paper"),
        Number("turns", "--turns", ArgKind::kNumber, "N", "of each rotation", 0.01, 1000, "1"),
        TextArg("finger", "--finger", "NAME", "the finger of explorations and sweep", "all"),
        Number("rays", "--rays", ArgKind::kInteger, "N", "rays of the noise-free map", 1, 360, "8"),
        only_paper,
        TextArg("models-dir", "--models-dir", "DIR", "where models are looked for first"),
        Number("workers", "--workers", ArgKind::kInteger, "N", "daemons at work", 1, 256,
               "one per core"),
        OutputDirectory()},
       Paper},
      {"experiment merge",
       kGroup,
       "join the shards of an experiment",
       nullptr,
       {directories, TableFormatArg(), PrintedSizeArg(), OutputDirectory()},
       Merge},
  };
}

}  // namespace regrasp::cli
