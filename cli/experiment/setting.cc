#include "cli/experiment/setting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <sstream>

#include "cli/client/errors.h"
#include "cli/grammar/grammar.h"
#include "cli/grammar/ranges.h"
#include "cli/grammar/units.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {
namespace {

constexpr double kGravity = 9.81;  // [m/s2], as in the scenario
constexpr const char* kGravityName = "gravity";

/// A number of a case within `range`.
double Limited(const std::string& key, const std::string& value, const char* unit,
               std::pair<double, double> range) {
  const std::string what = "--case " + key;
  const double number = *unit != '\0' ? ParseQuantity(value, what, unit) : ParseNumber(value, what);
  const auto [least, most] = range;
  if (number < least || number > most)
    throw CliError(kUsage, fmt::format("{} {}: allowed are {} to {}{}{}", what, value, least, most,
                                       *unit != '\0' ? " " : "", unit));
  return number;
}

/// Names of parameters, but for gravity's, have a point: this one is no parameter either.
CliError NoKey(const std::string& key) {
  const std::vector<std::string> known = {"object", "tilt",      "push",
                                          "turns",  "criterion", kGravityName};
  return {kUsage, fmt::format("--case: no key '{}'{}; allowed are {} and names of parameters", key,
                              OrNearest(key, known), fmt::join(known, ", "))};
}

void Add(const std::string& key, const std::string& value, Setting* setting) {
  if (value.empty()) throw CliError(kUsage, fmt::format("--case {}= has no value", key));
  if (key == "object")
    setting->object = ModelName(value);
  else if (key == "tilt")
    setting->tilt_deg = Limited(key, value, "deg", {-kMostTilt_deg, kMostTilt_deg});
  else if (key == "push")
    setting->push_n = Limited(key, value, "N", {0, RangeOnWire("push", "force_n").second});
  else if (key == "turns")
    setting->turns = Limited(key, value, "", RangeOnWire("rotate", "turns"));
  else if (key == "criterion")
    setting->criterion = value;
  else if (key == kGravityName || key.find('.') != std::string::npos)
    setting->set.emplace_back(key, value);
  else
    throw NoKey(key);
}

}  // namespace

std::pair<double, double> RangeOnWire(const char* method, const char* parameter, double unit) {
  const ParamSpec& spec = *FindParam(*FindMethod(method), parameter);
  return {spec.min / unit, spec.max / unit};
}

std::string ModelName(const std::string& text) {
  return text.find('/') == std::string::npos ? text : std::filesystem::absolute(text).string();
}

std::pair<std::string, std::string> NameAndValue(const std::string& word, const char* flag) {
  const auto equals = word.find('=');
  if (equals == std::string::npos || equals == 0)
    throw CliError(kUsage, fmt::format("{} '{}' is not NAME=VALUE", flag, word),
                   "regrasp param list");
  return {word.substr(0, equals), word.substr(equals + 1)};
}

Case ParseCase(const std::string& text) {
  Case c;
  const auto colon = text.find(':');
  c.name = text.substr(0, colon);
  if (c.name.empty() || c.name.find_first_of("'\n") != std::string::npos)
    throw CliError(kUsage, fmt::format("--case '{}' has no name without quotes", text));
  std::set<std::string> keys;
  std::istringstream words(colon == std::string::npos ? text : text.substr(colon + 1));
  for (std::string word; words >> word;) {
    const auto [key, value] = NameAndValue(word, "--case");
    if (!keys.insert(key).second)
      throw CliError(kUsage, fmt::format("--case '{}': {} is given twice", text, key));
    Add(key, value, &c.setting);
  }
  return c;
}

std::string Text(const Case& c) {
  std::string text = c.name + ":";
  if (!c.setting.object.empty()) text += " object=" + c.setting.object;
  if (c.setting.tilt_deg) text += fmt::format(" tilt={}", *c.setting.tilt_deg);
  if (c.setting.push_n) text += fmt::format(" push={}", *c.setting.push_n);
  if (!c.setting.criterion.empty()) text += " criterion=" + c.setting.criterion;
  if (c.setting.turns) text += fmt::format(" turns={}", *c.setting.turns);
  for (const auto& [name, value] : c.setting.set) text += fmt::format(" {}={}", name, value);
  return text;
}

Setting Join(Setting common, const Setting& special) {
  if (!special.object.empty()) common.object = special.object;
  const auto drop = [&common](const std::string& name) {
    std::erase_if(common.set, [&name](const auto& item) { return item.first == name; });
  };
  if (special.tilt_deg) {
    common.tilt_deg = special.tilt_deg;
    drop(kGravityName);
  }
  if (special.push_n) common.push_n = special.push_n;
  if (special.turns) common.turns = special.turns;
  if (!special.criterion.empty()) common.criterion = special.criterion;
  for (const auto& [name, value] : special.set) {
    drop(name);
    if (name == kGravityName) common.tilt_deg.reset();
    common.set.emplace_back(name, value);
  }
  return common;
}

std::vector<Case> Sweep(const std::vector<Case>& cases, const std::string& parameter,
                        const std::vector<std::string>& values) {
  std::vector<Case> swept;
  const std::size_t crossed = std::max<std::size_t>(1, cases.size());
  for (std::size_t i = 0; i < crossed; ++i) {
    const Case of = cases.empty() ? Case{} : cases[i];
    const auto name = [&](const std::string& base, const std::string& value) {
      return fmt::format("{}{}{}={}", base, base.empty() ? "" : ", ", parameter, value);
    };
    std::vector<std::string> before = of.against;
    if (before.empty() && i > 0) before = {cases.front().name};
    for (const std::string& value : values) {
      Case c = of;
      c.name = name(of.name, value);
      c.setting.set.emplace_back(parameter, value);
      c.against = {name(of.name, values.front())};
      for (const std::string& base : before) c.against.push_back(name(base, value));
      swept.push_back(std::move(c));
    }
  }
  return swept;
}

std::vector<std::pair<std::string, Json>> Parameters(const Setting& setting) {
  std::vector<std::pair<std::string, Json>> parameters;
  if (setting.tilt_deg) {
    const double tilt = *setting.tilt_deg * std::numbers::pi / 180;
    parameters.emplace_back(
        kGravityName, std::vector<double>{0, kGravity * std::cos(tilt), kGravity * std::sin(tilt)});
  }
  for (const auto& [name, value] : setting.set)
    parameters.emplace_back(name, ParseParameterValue(value));
  return parameters;
}

}  // namespace regrasp::cli
