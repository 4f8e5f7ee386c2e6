// The keys of the configuration as a table: file, environment and flags are read through it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "core/common/limit_text.h"
#include "core/common/nearest_name.h"
#include "core/protocol/config_path.h"
#include "core/protocol/methods.h"
#include "core/protocol/start_words.h"
#include "core/sensing/noise.h"
#include "daemon/config/config.h"
#include "daemon/loop/pacing.h"

namespace regrasp {
namespace {

using C = DaemonConfig;

template <std::string C::*Member>
constexpr ConfigKey TextKey(std::string_view name, std::string_view metavar,
                            std::string_view sentence, bool live = false) {
  return {name,
          metavar,
          sentence,
          KeyKind::kText,
          [](const C& config) { return config.*Member; },
          [](C& config, const std::string& text) { config.*Member = text; },
          live};
}

template <bool C::*Member>
constexpr ConfigKey FlagKey(std::string_view name, std::string_view sentence) {
  return {name,
          "",
          sentence,
          KeyKind::kBool,
          [](const C& config) -> std::string { return config.*Member ? "true" : "false"; },
          [](C& config, const std::string& text) { config.*Member = text == "true"; }};
}

/// A budget; what happens at it is said in docs/promises.md.
template <int C::*Member>
constexpr ConfigKey CountKey(std::string_view name, std::string_view sentence, double max) {
  return {name,
          "N",
          sentence,
          KeyKind::kInteger,
          [](const C& config) { return std::to_string(config.*Member); },
          [](C& config, const std::string& text) { config.*Member = std::stoi(text); },
          false,
          1,
          max};
}

constexpr std::array kKeys = {
    TextKey<&C::socket>("socket", "PATH", "where to listen; empty: $XDG_RUNTIME_DIR, /run or /tmp"),
    TextKey<&C::output_dir>("output_dir", "DIR",
                            "where pictures go; empty: ~/.local/state/regrasp"),
    ConfigKey{"seed", "N", "seed of the first run", KeyKind::kInteger,
              [](const C& config) { return std::to_string(config.seed); },
              [](C& config, const std::string& text) { config.seed = std::stoull(text); }, false, 0,
              kMaxSafeInteger},
    TextKey<&C::hand>("hand", "NAME|FILE.urdf", "name of the hand, or a .urdf file"),
    TextKey<&C::object>("object", "NAME|FILE.urdf",
                        "name of the object, or a .urdf file; empty: the scenario's"),
    TextKey<&C::models_dir>("models_dir", "DIR", "searched for models before the usual places"),
    FlagKey<&C::inertia_from_shape>("inertia_from_shape",
                                    "centre of mass and inertia of the object, and what a hand's "
                                    "links lack, from their shapes"),
    FlagKey<&C::force>("force", "take an object whose moment, centre of mass or density cannot be"),
    FlagKey<&C::fill_missing_meshes>(
        "fill_missing_meshes", "a capsule along the link where a hand's mesh file is not there"),
    ConfigKey{"speed", "X|max", "times real time, or \"max\"", KeyKind::kSpeed,
              [](const C& config) { return config.speed; },
              [](C& config, const std::string& text) { config.speed = text; }},
    TextKey<&C::clock>("clock", "MODE",
                       "continuous; lockstep: time advances only while a job runs or a step asks"),
    FlagKey<&C::paused>("paused", "begin with the clock stopped"),
    TextKey<&C::noise>("noise", "PRESET", "preset of sensor noise: off, fine, paper, coarse, taxel",
                       true),
    ConfigKey{"max_clients", "N", "connections at the same time", KeyKind::kInteger,
              [](const C& config) { return std::to_string(config.max_clients); },
              [](C& config, const std::string& text) { config.max_clients = std::stoi(text); },
              true, 1, 1000},
    CountKey<&C::max_recording_mb>("max_recording_mb",
                                   "megabytes of one run file; then it is ended", 1e6),
    CountKey<&C::max_incidents>("max_incidents", "incidents kept; then the oldest goes", 1e5),
    CountKey<&C::max_pictures>("max_pictures",
                               "pictures kept; then the oldest that nobody named goes", 1e5),
    CountKey<&C::max_checkpoints>("max_checkpoints",
                                  "checkpoints kept; then saving another is refused", 1e5),
    CountKey<&C::max_commands>("max_commands",
                               "commands of one run; then more are refused until a reset", 1e7),
    TextKey<&C::log_level>("log_level", "LEVEL", "trace, debug, info, warn, error or off", true),
    TextKey<&C::log_format>("log_format", "FORMAT", "text or json, on standard error"),
    TextKey<&C::stepper>("stepper", "NAME",
                         "fast, exact (slow reference), round (fast, friction cone), or auto"),
};

static_assert(std::ranges::equal(kKeys, kConfigKeyNames, {}, &ConfigKey::name));

void CheckWord(const std::string& where, std::string_view key, const std::string& value,
               const std::vector<std::string_view>& allowed) {
  if (std::ranges::find(allowed, value) != allowed.end()) return;
  throw ConfigError(fmt::format("{}{} = \"{}\": expected {}{}", where, key, value,
                                fmt::join(allowed, ", "), OrNearest(value, allowed)));
}

}  // namespace

std::span<const ConfigKey> ConfigKeys() { return kKeys; }

std::string FlagOf(const ConfigKey& key) {
  std::string flag = "--" + std::string(key.name);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

std::string VariableOf(const ConfigKey& key) {
  std::string name = "REGRASP_" + std::string(key.name);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::toupper(c); });
  return name;
}

void SetKey(DaemonConfig* config, const ConfigKey& key, const std::string& text,
            const std::string& origin) {
  const std::string where = origin + ": ";
  if (key.kind == KeyKind::kBool && text != "true" && text != "false")
    throw ConfigError(fmt::format("{}{} = {}: expected true or false", where, key.name, text));
  if (key.kind == KeyKind::kInteger) {
    std::int64_t value = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = error == std::errc() && rest == text.data() + text.size();
    if (!whole || value < static_cast<std::int64_t>(key.min) ||
        value > static_cast<std::int64_t>(key.max))
      throw ConfigError(fmt::format("{}{} = {}: expected an integer, {} ... {}", where, key.name,
                                    text, LeastText(key.min), MostText(key.max)));
  }
  const std::string before = key.get(*config);
  key.set(*config, text);
  try {
    CheckConfig(*config, where);
  } catch (const ConfigError&) {
    key.set(*config, before);  // so that the next key is judged for itself
    throw;
  }
  config->origins[std::string(key.name)] = origin;
}

double ParseSpeed(const std::string& text) {
  if (text == "max") return kMaxSpeed;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(value >= 1e-3 && value <= 1e3))
    throw ConfigError(fmt::format("speed = \"{}\": expected 0.001 ... 1000, or max", text));
  return value;
}

void CheckConfig(const DaemonConfig& config, const std::string& where) {
  const auto presets = NoisePresetNames();
  CheckWord(where, "noise", config.noise, {presets.begin(), presets.end()});
  CheckWord(where, "log_level", config.log_level,
            {"trace", "debug", "info", "warn", "error", "off"});
  CheckWord(where, "log_format", config.log_format, {"text", "json"});
  CheckWord(where, "clock", config.clock, {kClockWords.begin(), kClockWords.end()});
  CheckWord(where, "stepper", config.stepper, {kStepperWords.begin(), kStepperWords.end()});
  if (config.hand.empty()) throw ConfigError(where + "hand is empty");
  if (config.max_clients < 1 || config.max_clients > 1000)
    throw ConfigError(
        fmt::format("{}max_clients = {}: expected 1 ... 1000", where, config.max_clients));
  try {
    ParseSpeed(config.speed);
  } catch (const ConfigError& e) {
    throw ConfigError(where + e.what());
  }
}

}  // namespace regrasp
