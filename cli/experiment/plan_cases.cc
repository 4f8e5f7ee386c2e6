// What a plan's sweeps, objects and hazards are as cases.

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "cli/client/errors.h"
#include "cli/experiment/plan.h"
#include "cli/experiment/plan_words.h"

namespace regrasp::cli {
namespace {

constexpr double kHazardPush = 1;  // [N]

}  // namespace

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
    for (const Case& c : plan->cases)
      for (const auto& [own, ignored] : c.setting.set)
        if (own == name)
          throw CliError(kUsage, fmt::format("--set {}={}: the case '{}' gives {}, too", name,
                                             value, c.name, name));
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
      c.against = {fmt::format("{}, {}", object, plan->gaits.front())};
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

}  // namespace regrasp::cli
