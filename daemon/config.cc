#include "daemon/config.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "core/common/nearest_name.h"
#include "core/protocol/methods.h"
#include "core/sensing/noise.h"
#include "daemon/pacing.h"

namespace regrasp {
namespace {

/// One key of the file. `read` returns what is allowed when the value's type is wrong, else "".
struct Key {
  std::string_view name;
  std::string_view sentence;
  std::string (*read)(const toml::node&, DaemonConfig&);
  std::string (*shown)(const DaemonConfig&);
};

std::string Quoted(const std::string& text) { return fmt::format("\"{}\"", text); }

template <std::string DaemonConfig::*Member>
std::string ReadText(const toml::node& node, DaemonConfig& config) {
  const auto value = node.value_exact<std::string>();
  if (!value) return "a string";
  config.*Member = *value;
  return {};
}

template <std::string DaemonConfig::*Member>
std::string ShowText(const DaemonConfig& config) {
  return Quoted(config.*Member);
}

template <std::string DaemonConfig::*Member>
constexpr Key TextKey(std::string_view name, std::string_view sentence) {
  return {name, sentence, ReadText<Member>, ShowText<Member>};
}

using C = DaemonConfig;

const std::array kKeys = {
    TextKey<&C::socket>("socket", "where to listen; empty: $XDG_RUNTIME_DIR, /run or /tmp"),
    TextKey<&C::output_dir>("output_dir", "where pictures go; empty: ~/.local/state/regrasp"),
    Key{"seed", "seed of the first run",
        [](const toml::node& node, C& config) -> std::string {
          const auto value = node.value_exact<std::int64_t>();
          if (!value || *value < 0 || static_cast<double>(*value) > kMaxSafeInteger)
            return "an integer, 0 ... 2^53";
          config.seed = static_cast<std::uint64_t>(*value);
          return {};
        },
        [](const C& config) { return std::to_string(config.seed); }},
    TextKey<&C::hand>("hand", "name of the hand, or a .urdf file"),
    TextKey<&C::object>("object", "name of the object, or a .urdf file; empty: the scenario's"),
    TextKey<&C::models_dir>("models_dir", "searched for models before the usual places"),
    Key{"speed", "times real time, or \"max\"",
        [](const toml::node& node, C& config) -> std::string {
          if (const auto text = node.value_exact<std::string>())
            config.speed = *text;
          else if (const auto number = node.value<double>())
            config.speed = fmt::format("{}", *number);
          else
            return "a number, or \"max\"";
          return {};
        },
        [](const C& config) { return config.speed; }},
    Key{"paused", "begin with the clock stopped",
        [](const toml::node& node, C& config) -> std::string {
          const auto value = node.value_exact<bool>();
          if (!value) return "true or false";
          config.paused = *value;
          return {};
        },
        [](const C& config) -> std::string { return config.paused ? "true" : "false"; }},
    TextKey<&C::noise>("noise", "preset of sensor noise: off, fine, paper, coarse, taxel"),
    Key{"max_clients", "connections at the same time",
        [](const toml::node& node, C& config) -> std::string {
          const auto value = node.value_exact<std::int64_t>();
          if (!value || *value < 1 || *value > 1000) return "an integer, 1 ... 1000";
          config.max_clients = static_cast<int>(*value);
          return {};
        },
        [](const C& config) { return std::to_string(config.max_clients); }},
    TextKey<&C::log_level>("log_level", "trace, debug, info, warn, error or off"),
    TextKey<&C::log_format>("log_format", "text or json"),
    TextKey<&C::stepper>("stepper", "fast, or exact: the slow reference"),
};

std::string DidYouMean(std::string_view wanted, const std::vector<std::string_view>& names) {
  const std::string_view near = NearestName(wanted, names);
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near);
}

struct Reader {
  const std::string& path;
  DaemonConfig* config;

  [[noreturn]] void Fail(const toml::node& node, const std::string& message) const {
    throw ConfigError(fmt::format("{}:{}: {}", path, node.source().begin.line, message));
  }

  void ReadParameter(const std::string& name, const toml::node& node) const {
    const int index = FindParameter(name);
    if (index < 0) {
      std::vector<std::string_view> names;
      for (const ParameterInfo& info : ParameterTable()) names.push_back(info.name);
      Fail(node, fmt::format("unknown parameter '{}'{}", name, DidYouMean(name, names)));
    }
    const ParameterInfo& info = ParameterTable()[static_cast<std::size_t>(index)];
    const std::string allowed =
        fmt::format("{} ... {}{}{}", info.min, info.max, info.unit.empty() ? "" : " ", info.unit);
    Vector3d value = Vector3d::Zero();
    const auto read = [&](const toml::node& item, int i) {
      const auto number = item.is_number() ? item.value<double>() : std::nullopt;
      if (!number || !(*number >= info.min && *number <= info.max))
        Fail(node, fmt::format("{}: expected {}{}", name,
                               info.size == 1 ? "a number, " : "3 numbers, each ", allowed));
      value[i] = *number;
    };
    if (info.size == 1) {
      read(node, 0);
    } else {
      const toml::array* items = node.as_array();
      if (!items || items->size() != 3)
        Fail(node, fmt::format("{}: expected 3 numbers, each {}", name, allowed));
      for (int i = 0; i < 3; ++i) read((*items)[static_cast<std::size_t>(i)], i);
    }
    config->parameters.emplace_back(name, value);
  }

  /// [parameters] may be written with quoted names, dotted keys or sub-tables.
  void ReadParameters(const toml::table& table, const std::string& prefix) const {
    for (const auto& [key, node] : table) {
      const std::string name = prefix + std::string(key.str());
      if (const toml::table* inner = node.as_table())
        ReadParameters(*inner, name + ".");
      else
        ReadParameter(name, node);
    }
  }

  void Read(const toml::table& root) const {
    for (const auto& [key, node] : root) {
      if (key.str() == "parameters") {
        const toml::table* table = node.as_table();
        if (!table) Fail(node, "parameters is a table");
        ReadParameters(*table, "");
        continue;
      }
      const auto it = std::ranges::find(kKeys, key.str(), &Key::name);
      if (it == kKeys.end()) {
        std::vector<std::string_view> names = {"parameters"};
        for (const Key& known : kKeys) names.push_back(known.name);
        Fail(node, fmt::format("unknown key '{}'{}", key.str(), DidYouMean(key.str(), names)));
      }
      if (const std::string expected = it->read(node, *config); !expected.empty())
        Fail(node, fmt::format("{}: expected {}", key.str(), expected));
      try {
        CheckConfig(*config, "");
      } catch (const ConfigError& e) {
        Fail(node, e.what());
      }
    }
  }
};

void CheckWord(const std::string& where, std::string_view key, const std::string& value,
               const std::vector<std::string_view>& allowed) {
  if (std::ranges::find(allowed, value) != allowed.end()) return;
  throw ConfigError(fmt::format("{}{} = \"{}\": expected {}{}", where, key, value,
                                fmt::join(allowed, ", "), DidYouMean(value, allowed)));
}

}  // namespace

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
  CheckWord(where, "stepper", config.stepper, {"fast", "exact"});
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

void ReadConfigFile(const std::string& path, DaemonConfig* config) {
  if (::access(path.c_str(), R_OK) != 0) throw ConfigError(fmt::format("{}: cannot be read", path));
  try {
    Reader{path, config}.Read(toml::parse_file(path));
  } catch (const toml::parse_error& e) {
    throw ConfigError(fmt::format("{}:{}: {}", path, e.source().begin.line, e.description()));
  }
}

std::string DefaultConfigText() {
  const DaemonConfig config;
  std::string text = "# Configuration of regraspd: every key with its built-in value.\n\n";
  for (const Key& key : kKeys)
    text += fmt::format("{} = {}  # {}\n", key.name, key.shown(config), key.sentence);
  text +=
      "\n# Parameters of the simulation and the controller. Mass, friction and gravity come from "
      "the\n"
      "# models unless they are set here.\n[parameters]\n";
  Parameters parameters;
  for (const ParameterInfo& info : ParameterTable()) {
    const double* value = info.access(parameters);
    const std::string shown = info.size == 1
                                  ? fmt::format("{}", value[0])
                                  : fmt::format("[{}, {}, {}]", value[0], value[1], value[2]);
    const std::string unit = info.unit.empty() ? "" : fmt::format("[{}] ", info.unit);
    text += fmt::format("# \"{}\" = {}  # {}{} {} ... {}\n", info.name, shown, unit,
                        info.description, info.min, info.max);
  }
  return text;
}

std::string DefaultOutputDir() {
  const auto variable = [](const char* name) -> std::string {
    const char* value = std::getenv(name);
    return value ? value : "";
  };
  if (const std::string state = variable("XDG_STATE_HOME"); !state.empty())
    return state + "/regrasp";
  if (const std::string home = variable("HOME"); !home.empty())
    return home + "/.local/state/regrasp";
  return fmt::format("/tmp/regrasp-{}/output", ::geteuid());
}

}  // namespace regrasp
