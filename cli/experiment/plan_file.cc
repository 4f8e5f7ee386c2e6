// A plan as experiment.json has it, and how two differ.

#include <fmt/format.h>

#include <tuple>

#include "cli/client/errors.h"
#include "cli/experiment/plan.h"
#include "cli/experiment/plan_words.h"
#include "cli/print/print.h"
#include "core/common/fnv1a.h"

namespace regrasp::cli {
namespace {

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

}  // namespace

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
  if (p.common.push_n > 0) json["push_n"] = *p.common.push_n;
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
    if (json.contains("push_n")) p.common.push_n = json.at("push_n").get<double>();
    for (const auto& [name, value] : json.at("set").items()) p.common.set.emplace_back(name, value);
    if (json.contains("cases"))
      for (const std::string text : json.at("cases")) p.cases.push_back(ParseCase(text));
    for (Case& c : p.cases)
      if (const Json& against = At(At(json, "against"), c.name.c_str()); against.is_array())
        c.against = against.get<std::vector<std::string>>();
      else if (against.is_string())  // as versions before wrote it
        c.against = {against.get<std::string>()};
    // Written by versions before 0.2: unknown, and so not the same as what is known.
    p.stepper = json.value("stepper", "unknown");
    p.parameters = At(json, "parameters");
    p.models = At(json, "models");
    p.built_from = json.value("built_from", "unknown");
    p.version = json.at("version");
    p.build = json.at("build");
    if (json.contains("shard")) std::tie(p.shard, p.shards) = ReadShard(json.at("shard"));
    return p;
  } catch (const std::exception& error) {
    throw CliError(kIo, fmt::format("{} does not describe an experiment: {}", path, error.what()),
                   "ls " + path);
  }
}

std::string KeyOf(const Plan& plan) {
  Json json = ToJson(plan);
  json.erase("seeds");
  json.erase("shard");
  return fmt::format("{:016x}", Fnv1a(json.dump()));
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

}  // namespace regrasp::cli
