// The plan that a command line asks for.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <tuple>

#include "cli/client/errors.h"
#include "cli/experiment/plan.h"
#include "cli/experiment/plan_words.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

/// Names separated by commas, each one of `allowed`, in the order of `allowed`.
std::vector<std::string> Names(const std::string& text, const std::vector<std::string>& allowed,
                               const std::string& flag) {
  const auto given = Split(text, ',');
  for (const auto& name : given)
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
      throw CliError(kUsage,
                     fmt::format("{} '{}' is none of {}", flag, name, fmt::join(allowed, ", ")));
  std::vector<std::string> names;
  for (const auto& name : allowed)
    if (std::find(given.begin(), given.end(), name) != given.end()) names.push_back(name);
  if (names.empty()) throw CliError(kUsage, fmt::format("{} is empty", flag));
  return names;
}

std::vector<std::string> ValuesOf(const char* method, const char* parameter) {
  const ParamSpec* spec = FindParam(*FindMethod(method), parameter);
  return {spec->values.begin(), spec->values.end()};
}

std::vector<std::string> Axes(const std::string& text) {
  if (text == "all") return {"1,0,0", "-1,0,0", "0,1,0", "0,-1,0", "0,0,1", "0,0,-1"};
  const auto v = ParseNumbers(text, 3, "--axis");
  if (v[0] == 0 && v[1] == 0 && v[2] == 0)
    throw CliError(kUsage, "--axis 0,0,0 has no direction",
                   "regrasp experiment rotation --axis 0,0,-1 -o DIR");
  return {fmt::format("{},{},{}", v[0], v[1], v[2])};
}

/// Throws CliError(kUsage) when a parameter is given twice.
void CheckGivenOnce(const Setting& setting, const std::string& where) {
  std::set<std::string> names;
  if (setting.tilt_deg) names.insert("gravity");  // a tilt is one
  for (const auto& [name, value] : setting.set)
    if (!names.insert(name).second)
      throw CliError(kUsage, fmt::format("{}: {} is given twice", where, name),
                     fmt::format("give {} once", name));
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
  if (prediction) p.objects = Split(invocation.Text("objects", kPredictionObjects), ',');
  if (zoo) {
    p.objects = Split(invocation.Text("objects", "zoo"), ',');
    p.gaits = Names(invocation.Text("gaits", "planned,returning"),
                    {"planned", "returning", "exploring"}, "--gaits");
  }
  if (p.rotation()) {
    p.subjects = Axes(invocation.Text("axis", "0,0,-1"));
    if (invocation.Has("turns") && invocation.Has("angle"))
      throw CliError(kUsage, "--turns and --angle exclude each other");
    p.turns = invocation.Has("angle") ? ParseNumber(invocation.Text("angle"), "--angle") / 360
                                      : ParseNumber(invocation.Text("turns", "1"), "--turns");
    if (p.turns == 0)
      throw CliError(kUsage, "an angle of 0 leaves nothing to turn",
                     "regrasp experiment rotation --turns 1 -o DIR");
    p.speed_deg_s = ParseNumber(invocation.Text("speed", "0"), "--speed");
  } else {
    p.subjects = Split(invocation.Text("finger", "all"), ',');
    const auto estimators = ValuesOf("explore", "estimator");
    p.estimators =
        Names(invocation.Text("estimator", sweep ? fmt::format("{}", fmt::join(estimators, ","))
                                                 : "least_squares"),
              estimators, "--estimator");
    p.criterion = invocation.Text("criterion", "manipulability");
    p.rays = static_cast<int>(Integer(invocation, "rays", "12"));
  }
  p.hand = ModelName(invocation.Text("hand"));
  p.common.object = ModelName(invocation.Text("object"));
  if (invocation.Has("models-dir"))
    p.models_dir = fs::absolute(invocation.Text("models-dir")).string();
  if (invocation.Has("tilt")) p.common.tilt_deg = ParseNumber(invocation.Text("tilt"), "--tilt");
  p.common.push_n = ParseNumber(invocation.Text("push", "0"), "--push");
  for (const auto& word : Split(invocation.Text("set"), '\n'))
    p.common.set.push_back(NameAndValue(word, "--set"));
  CheckGivenOnce(p.common, "--set");
  p.stepper = invocation.Text("stepper", "fast");
  for (const auto& text : Split(invocation.Text("case"), '\n')) {
    p.cases.push_back(ParseCase(text));
    const Case& c = p.cases.back();
    CheckGivenOnce(c.setting, fmt::format("--case '{}'", text));
    if ((c.setting.push_n != 0 || c.setting.turns) && !p.rotation())
      throw CliError(kUsage, fmt::format("--case '{}': push and turns are for rotations", text));
    if (!c.setting.criterion.empty()) {
      if (p.rotation())
        throw CliError(kUsage, fmt::format("--case '{}': a criterion is for explorations", text));
      Names(c.setting.criterion, ValuesOf("explore", "criterion"),
            fmt::format("--case '{}': criterion", text));
    }
    if (c.setting.turns == 0.0)
      throw CliError(kUsage, fmt::format("--case '{}': 0 turns leave nothing to turn", text));
    if (std::count_if(p.cases.begin(), p.cases.end(),
                      [&](const Case& other) { return other.name == c.name; }) > 1)
      throw CliError(kUsage, fmt::format("two cases have the name '{}'", c.name));
  }
  if (invocation.Has("shard")) std::tie(p.shard, p.shards) = ReadShard(invocation.Text("shard"));
  return p;
}

}  // namespace regrasp::cli
