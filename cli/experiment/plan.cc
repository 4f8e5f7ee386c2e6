#include "cli/experiment/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <tuple>

#include "cli/client/errors.h"
#include "cli/print/print.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kHazardPush = 1;  // [N]

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

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

std::pair<int, int> Shard(const std::string& text) {
  const auto parts = Split(text, '/');
  const CliError bad(kUsage, fmt::format("--shard '{}' is not i/N with 1 <= i <= N", text),
                     "regrasp help experiment exploration");
  if (parts.size() != 2) throw bad;
  const double i = ParseNumber(parts[0], "--shard"), n = ParseNumber(parts[1], "--shard");
  if (i != static_cast<int>(i) || n != static_cast<int>(n) || i < 1 || i > n || n > 1e6) throw bad;
  return {static_cast<int>(i), static_cast<int>(n)};
}

/// Models and parameters are told by name, all else as a whole.
void AddDifference(const std::string& key, const Json& was, const Json& is, std::string* text) {
  if (was == is) return;
  const bool nested = key.starts_with("models") || key.starts_with("parameters");
  if (nested && was.is_object() && is.is_object()) {
    for (const auto& [name, value] : was.items())
      AddDifference(key + "." + name, value, At(is, name.c_str()), text);
    for (const auto& [name, value] : is.items())
      if (!was.contains(name)) AddDifference(key + "." + name, Json(), value, text);
    return;
  }
  *text += fmt::format("{}{} was {}, is {}", text->empty() ? "" : "; ", key, was.dump(), is.dump());
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

std::size_t Plan::num_units() const {
  return num_cases() * noise.size() * subjects.size() * static_cast<std::size_t>(seeds);
}

Unit Plan::unit(std::size_t index) const {
  const auto n = static_cast<std::size_t>(seeds);
  const std::size_t per_noise = n * subjects.size(), per_case = per_noise * noise.size();
  return {index / per_case, noise[index % per_case / per_noise],
          subjects[index / n % subjects.size()], first_seed + static_cast<std::int64_t>(index % n)};
}

std::size_t Plan::Grown(std::size_t index, std::int64_t of_seeds) const {
  const auto before = static_cast<std::size_t>(of_seeds);
  return index / before * static_cast<std::size_t>(seeds) + index % before;
}

Setting Plan::setting(std::size_t which) const {
  return cases.empty() ? common : Join(common, cases.at(which).setting);
}

std::vector<std::size_t> Plan::Mine() const {
  std::vector<std::size_t> mine;
  for (std::size_t i = static_cast<std::size_t>(shard) - 1; i < num_units();
       i += static_cast<std::size_t>(shards))
    mine.push_back(i);
  return mine;
}

std::string Plan::Command(const Unit& unit, const std::string& estimator) const {
  std::string text = fmt::format("regrasp experiment {}", rotation() ? "rotation" : "exploration");
  if (rotation()) {
    text += fmt::format(" --axis={} --turns {}", unit.subject, turns);
    if (speed_deg_s > 0) text += fmt::format(" --speed {}", speed_deg_s);
  } else {
    text += fmt::format(" --finger {} --criterion {} --estimator {} --rays {}", unit.subject,
                        criterion, estimator, rays);
  }
  text += fmt::format(" --noise {} --seed {} -n 1", unit.noise, unit.seed);
  for (const auto& [flag, value] : {std::pair{"hand", hand}, std::pair{"object", common.object}})
    if (!value.empty()) text += fmt::format(" --{} {}", flag, value);
  if (common.tilt_deg) text += fmt::format(" --tilt {}", *common.tilt_deg);
  if (common.push_n > 0) text += fmt::format(" --push {}", common.push_n);
  for (const auto& [name, value] : common.set) text += fmt::format(" --set {}={}", name, value);
  if (stepper != "fast") text += " --stepper " + stepper;
  if (!cases.empty()) text += fmt::format(" --case '{}'", Text(cases.at(unit.which)));
  return text + " -o trial";
}

std::vector<std::string> Plan::DaemonArguments(std::size_t which) const {
  std::vector<std::string> words;
  const std::string object = setting(which).object;
  for (const auto& [flag, value] : {std::pair{"--hand", hand}, std::pair{"--object", object},
                                    std::pair{"--models-dir", models_dir}})
    if (!value.empty()) words.insert(words.end(), {flag, value});
  words.insert(words.end(), {"--stepper", stepper});
  return words;
}

Json ToJson(const Plan& p) {
  Json set = Json::object();
  for (const auto& [name, value] : p.common.set) set[name] = value;
  Json json = {{"experiment", p.experiment}, {"noise", p.noise}};
  json[p.rotation() ? "axes" : "fingers"] = p.subjects;
  if (p.rotation()) {
    json["turns"] = p.turns;
    json["speed_deg_s"] = p.speed_deg_s;
  } else {
    json["estimators"] = p.estimators;
    json["criterion"] = p.criterion;
    json["rays"] = p.rays;
  }
  json["first_seed"] = p.first_seed;
  json["seeds"] = p.seeds;
  json["hand"] = p.hand;
  json["object"] = p.common.object;
  if (p.common.tilt_deg) json["tilt_deg"] = *p.common.tilt_deg;
  if (p.common.push_n > 0) json["push_n"] = p.common.push_n;
  json["set"] = set;
  for (const Case& c : p.cases) json["cases"].push_back(Text(c));
  for (const Case& c : p.cases)
    if (!c.against.empty()) json["against"][c.name] = c.against;
  json["stepper"] = p.stepper;
  json["parameters"] = p.parameters;
  json["models"] = p.models;
  json["version"] = p.version;
  json["build"] = p.build;
  json["built_from"] = p.built_from;
  if (p.shards > 1) json["shard"] = fmt::format("{}/{}", p.shard, p.shards);
  return json;
}

Plan PlanFromJson(const Json& json, const std::string& path) {
  try {
    Plan p;
    p.experiment = json.at("experiment");
    p.noise = json.at("noise");
    p.subjects = json.at(p.rotation() ? "axes" : "fingers").get<std::vector<std::string>>();
    if (p.rotation()) {
      p.turns = json.at("turns");
      p.speed_deg_s = json.at("speed_deg_s");
    } else {
      p.estimators = json.at("estimators").get<std::vector<std::string>>();
      p.criterion = json.at("criterion");
      p.rays = json.at("rays");
    }
    p.first_seed = json.at("first_seed");
    p.seeds = json.at("seeds");
    p.hand = json.at("hand");
    p.common.object = json.at("object");
    if (json.contains("tilt_deg")) p.common.tilt_deg = json.at("tilt_deg").get<double>();
    p.common.push_n = json.value("push_n", 0.0);
    for (const auto& [name, value] : json.at("set").items()) p.common.set.emplace_back(name, value);
    if (json.contains("cases"))
      for (const std::string text : json.at("cases")) p.cases.push_back(ParseCase(text));
    for (Case& c : p.cases)
      if (const Json& against = At(At(json, "against"), c.name.c_str()); against.is_string())
        c.against = against;
    // Written by versions before 0.2: unknown, and so not the same as what is known.
    p.stepper = json.value("stepper", "unknown");
    p.parameters = At(json, "parameters");
    p.models = At(json, "models");
    p.built_from = json.value("built_from", "unknown");
    p.version = json.at("version");
    p.build = json.at("build");
    if (json.contains("shard")) std::tie(p.shard, p.shards) = Shard(json.at("shard"));
    return p;
  } catch (const std::exception& error) {
    throw CliError(kIo, fmt::format("{} does not describe an experiment: {}", path, error.what()),
                   "ls " + path);
  }
}

std::string Difference(const Plan& before, const Plan& now) {
  Json a = ToJson(before), b = ToJson(now);
  a.erase("shard");
  b.erase("shard");
  std::string text;
  for (const auto& [key, value] : a.items()) AddDifference(key, value, At(b, key.c_str()), &text);
  for (const auto& [key, value] : b.items())
    if (!a.contains(key)) AddDifference(key, Json(), value, &text);
  return text;
}

void ExpandSweeps(Plan* plan, const std::function<bool(const std::string&)>& is_vector) {
  std::vector<std::pair<std::string, std::string>> fixed;
  for (const auto& [name, value] : plan->common.set) {
    if (value.find(',') == std::string::npos || is_vector(name)) {
      fixed.emplace_back(name, value);
      continue;
    }
    const auto values = Split(value, ',');
    if (std::set(values.begin(), values.end()).size() < values.size() ||
        std::find(values.begin(), values.end(), "") != values.end())
      throw CliError(kUsage,
                     fmt::format("--set {}={}: a value is empty or given twice", name, value),
                     fmt::format("regrasp param get {}", name));
    plan->cases = Sweep(plan->cases, name, values);
  }
  plan->common.set = fixed;
}

void ExpandZoo(Plan* plan) {
  for (const std::string& object : plan->objects)
    for (const std::string& gait : plan->gaits) {
      Case c;
      c.name = fmt::format("{}, {}", object, gait);
      c.setting.object = object;
      c.setting.set = {{"gait.preset", gait == "planned" ? "planned" : "paper"}};
      if (gait == "returning") c.setting.set.emplace_back("gait.mode", gait);
      c.against = fmt::format("{}, {}", object, plan->gaits.front());
      plan->cases.push_back(std::move(c));
    }
}

void ExpandHazards(Plan* plan) {
  for (const std::string& object : plan->objects)
    for (const char* hazard : {"as it is", "pushed", "slippery"}) {
      Case c;
      c.name = fmt::format("{}, {}", object, hazard);
      c.setting.object = object;
      if (hazard == std::string("pushed")) c.setting.push_n = kHazardPush;
      if (hazard == std::string("slippery")) c.setting.set = {{"object.friction", "0.5"}};
      plan->cases.push_back(std::move(c));
    }
}

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
  if (invocation.Has("shard")) std::tie(p.shard, p.shards) = Shard(invocation.Text("shard"));
  return p;
}

}  // namespace regrasp::cli
