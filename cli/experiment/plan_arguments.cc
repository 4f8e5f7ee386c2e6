// The plan that a command line asks for.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "cli/client/errors.h"
#include "cli/experiment/plan.h"
#include "cli/experiment/plan_words.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

/// Names separated by commas, each one of `allowed`, in the order of `allowed`.
std::vector<std::string> Names(const std::string& text, const std::vector<std::string>& allowed,
                               const std::string& flag) {
  const auto given = NamesIn(text, flag);
  for (const auto& name : given)
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
      throw CliError(kUsage, fmt::format("{} '{}' is none of {}{}", flag, name,
                                         fmt::join(allowed, ", "), OrNearest(name, allowed)));
  std::vector<std::string> names;
  for (const auto& name : allowed)
    if (std::find(given.begin(), given.end(), name) != given.end()) names.push_back(name);
  return names;
}

std::vector<std::string> ValuesOf(const char* method, const char* parameter) {
  const ParamSpec* spec = FindParam(*FindMethod(method), parameter);
  return {spec->values.begin(), spec->values.end()};
}

std::vector<std::string> Axes(const std::string& text, const std::string& experiment) {
  if (text == "all") return {"1,0,0", "-1,0,0", "0,1,0", "0,-1,0", "0,0,1", "0,0,-1"};
  const auto v = ParseNumbers(text, 3, "--axis");
  const std::string hint = fmt::format("regrasp experiment {} --axis=0,0,-1 -o DIR", experiment);
  if (v[0] == 0 && v[1] == 0 && v[2] == 0)
    throw CliError(kUsage, "--axis 0,0,0 has no direction", hint);
  const double most = FindParam(*FindMethod("rotate"), "axis")->max;
  if (std::any_of(v.begin(), v.end(), [most](double x) { return std::abs(x) > most; }))
    throw CliError(kUsage, fmt::format("--axis {}: allowed are {} to {}", text, -most, most), hint);
  return {fmt::format("{},{},{}", v[0], v[1], v[2])};
}

/// Options that are parameters, too: {parameter: option}, of those that were given.
std::map<std::string, std::string> OptionsThatAreParameters(const std::string& experiment,
                                                            const Invocation& invocation) {
  std::map<std::string, std::string> options;
  if (invocation.Has("speed")) options["gait.speed_rad_s"] = "--speed";
  if (experiment == "zoo") options["gait.preset"] = options["gait.mode"] = "--gaits";
  return options;
}

/// Throws CliError(kUsage) when a parameter is given twice, by an option or by name.
void CheckGivenOnce(const Setting& setting, const std::string& where,
                    const std::map<std::string, std::string>& options) {
  std::set<std::string> names;
  if (setting.tilt_deg) names.insert("gravity");  // a tilt is one
  for (const auto& [name, value] : setting.set) {
    if (const auto option = options.find(name); option != options.end())
      throw CliError(kUsage, fmt::format("{}: {} is given by {}, too", where, name, option->second),
                     fmt::format("give {} once", name));
    if (!names.insert(name).second)
      throw CliError(kUsage, fmt::format("{}: {} is given twice", where, name),
                     fmt::format("give {} once", name));
  }
}

/// Throws CliError(kUsage) when a case says what its experiment has not, or what nothing allows.
void CheckCase(const Case& c, const Plan& plan, const std::string& where) {
  if ((c.setting.push_n || c.setting.turns) && !plan.rotation())
    throw CliError(kUsage, where + ": push and turns are for rotations");
  if (c.setting.turns == 0.0) throw CliError(kUsage, where + ": 0 turns leave nothing to turn");
  if (c.setting.criterion.empty()) return;
  if (plan.rotation()) throw CliError(kUsage, where + ": a criterion is for explorations");
  if (Names(c.setting.criterion, ValuesOf("explore", "criterion"), where + ": criterion").size() >
      1)
    throw CliError(kUsage, where + ": a case has one criterion");
}

std::int64_t Integer(const Invocation& invocation, const char* key, const char* otherwise) {
  return static_cast<std::int64_t>(
      ParseNumber(invocation.Text(key, otherwise), std::string("--") + key));
}

}  // namespace

Plan PlanFromArguments(const std::string& experiment, const Invocation& invocation) {
  Plan p;
  p.experiment = experiment;
  const bool sweep = experiment == "noise-sweep";
  const auto presets = ValuesOf("noise.set", "preset");
  const bool zoo = experiment == "zoo", prediction = experiment == "prediction";
  p.noise = Names(invocation.Text("noise", sweep        ? fmt::format("{}", fmt::join(presets, ","))
                                           : prediction ? "paper,coarse"
                                                        : "paper"),
                  presets, "--noise");
  p.first_seed = Integer(invocation, "seed", "1");
  p.seeds = Integer(invocation, "seeds",
                    prediction     ? "2"
                    : zoo          ? "5"
                    : p.rotation() ? "10"
                    : sweep        ? "20"
                                   : "50");
  if (prediction || zoo)
    p.objects = NamesIn(invocation.Text("objects", zoo ? kWholeZoo : kPredictionObjects),
                        "--objects", kWholeZoo);
  if (zoo) {
    p.gaits = Names(invocation.Text("gaits", "planned,returning"),
                    {"planned", "returning", "exploring"}, "--gaits");
  }
  if (p.rotation()) {
    p.subjects = Axes(invocation.Text("axis", "0,0,-1"), experiment);
    if (invocation.Has("turns") && invocation.Has("angle"))
      throw CliError(kUsage, "--turns and --angle exclude each other");
    p.turns = invocation.Has("angle") ? ParseNumber(invocation.Text("angle"), "--angle") / 360
                                      : ParseNumber(invocation.Text("turns", "1"), "--turns");
    if (p.turns == 0)
      throw CliError(kUsage, "an angle of 0 leaves nothing to turn",
                     fmt::format("regrasp experiment {} --turns 1 -o DIR", experiment));
    p.speed_deg_s = ParseNumber(invocation.Text("speed", "0"), "--speed");
  } else {
    p.subjects = NamesIn(invocation.Text("finger", kEveryFinger), "--finger", kEveryFinger);
    const ParamSpec& spec = *FindParam(*FindMethod("explore"), "estimator");
    const std::vector<std::string> estimators(spec.values.begin(), spec.values.end());
    p.estimators =
        Names(invocation.Text("estimator", sweep ? fmt::format("{}", fmt::join(estimators, ","))
                                                 : std::string(spec.default_text)),
              estimators, "--estimator");
    p.criterion = invocation.Text("criterion", "manipulability");
    p.rays = static_cast<int>(Integer(invocation, "rays", "12"));
  }
  p.hand = ModelName(invocation.Text("hand"));
  p.common.object = ModelName(invocation.Text("object"));
  if (invocation.Has("models-dir"))
    p.models_dir = fs::absolute(invocation.Text("models-dir")).string();
  if (invocation.Has("tilt")) p.common.tilt_deg = ParseNumber(invocation.Text("tilt"), "--tilt");
  if (invocation.Has("push")) p.common.push_n = ParseNumber(invocation.Text("push"), "--push");
  for (const auto& word : Split(invocation.Text("set"), '\n'))
    p.common.set.push_back(NameAndValue(word, "--set"));
  const auto options = OptionsThatAreParameters(experiment, invocation);
  CheckGivenOnce(p.common, "--set", options);
  p.stepper = invocation.Text("stepper", "fast");
  for (const auto& text : Split(invocation.Text("case"), '\n')) {
    p.cases.push_back(ParseCase(text));
    const Case& c = p.cases.back();
    CheckGivenOnce(c.setting, fmt::format("--case '{}'", text), options);
    CheckCase(c, p, fmt::format("--case '{}'", text));
    if (std::count_if(p.cases.begin(), p.cases.end(),
                      [&](const Case& other) { return other.name == c.name; }) > 1)
      throw CliError(kUsage, fmt::format("two cases have the name '{}'", c.name));
  }
  if (invocation.Has("shard")) std::tie(p.shard, p.shards) = ReadShard(invocation.Text("shard"));
  return p;
}

}  // namespace regrasp::cli
