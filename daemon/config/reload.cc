#include "daemon/config/reload.h"

#include <fmt/format.h>

#include <algorithm>

#include "daemon/wire/frame_json.h"

namespace regrasp {
namespace {

/// The value set last, or null.
const Vector3d* Find(const DaemonConfig& config, const std::string& parameter) {
  const Vector3d* found = nullptr;
  for (const auto& [name, value] : config.parameters)
    if (name == parameter) found = &value;
  return found;
}

const ParameterInfo& InfoOf(const std::string& name) {
  return ParameterTable()[static_cast<std::size_t>(FindParameter(name))];
}

ReloadCall SetParameterCall(const std::string& name, const Vector3d& value) {
  const ParameterInfo& info = InfoOf(name);
  const JsonIn json = ParameterValueJson(info, value);
  return {
      "param.set", {{"name", name}, {"value", json}}, fmt::format("{} = {}", name, json.dump())};
}

}  // namespace

ReloadPlan PlanReload(const DaemonConfig& running, const DaemonConfig& wanted) {
  ReloadPlan plan;
  for (const ConfigKey& key : ConfigKeys()) {
    const std::string value = key.get(wanted);
    if (key.get(running) == value) continue;
    const auto origin = wanted.origins.find(std::string(key.name));
    const std::string change =
        fmt::format("{} = {} ({})", key.name, value,
                    origin == wanted.origins.end() ? "built in" : origin->second);
    if (!key.live)
      plan.restart.push_back(change);
    else if (key.name == "noise")
      plan.calls.push_back({"noise.set", {{"preset", value}}, change});
    else
      plan.at_once.push_back(change);
  }
  auto parameters = wanted.parameters;
  std::ranges::stable_partition(parameters, IsPreset, [](const auto& parameter) -> decltype(auto) {
    return InfoOf(parameter.first);
  });
  bool preset_changes = false;
  for (const auto& [name, value] : parameters) {
    const Vector3d* before = Find(running, name);
    const bool changes = !(before && *before == value);
    if (*Find(wanted, name) != value) continue;
    // What a preset overwrites is set again.
    if (changes || (preset_changes && IsSetByPreset(InfoOf(name))))
      plan.calls.push_back(SetParameterCall(name, value));
    preset_changes = preset_changes || (changes && IsPreset(InfoOf(name)));
  }
  for (const auto& [name, value] : running.parameters)
    if (!Find(wanted, name))
      plan.restart.push_back(
          fmt::format("{} is no longer set and keeps its value; its default", name));
  return plan;
}

}  // namespace regrasp
