#include "daemon/config/config.h"

#include <fmt/format.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <sstream>

#include "core/common/nearest_name.h"
#include "core/files/toml_text.h"
#include "core/protocol/config_path.h"
#include "core/protocol/errors.h"
#include "core/protocol/user_directories.h"
#include "core/session/parameter_value.h"
#include "daemon/wire/frame_json.h"

namespace regrasp {
namespace {

/// A value as TOML writes it.
std::string Written(const toml::node& node) {
  std::ostringstream text;
  node.visit([&text](const auto& value) { text << value; });
  constexpr std::size_t kMost = 60;
  std::string written = text.str();
  std::replace(written.begin(), written.end(), '\n', ' ');
  if (written.size() <= kMost) return written;
  std::size_t end = kMost;
  while ((written[end] & 0xC0) == 0x80) --end;  // not within a UTF-8 character
  return written.substr(0, end) + "...";
}

/// What a node gives for a parameter; nothing where it is neither number, boolean, word nor list of
/// numbers.
std::optional<GivenValue> Given(const toml::node& node) {
  if (const auto flag = node.as_boolean()) return flag->get();
  if (const auto text = node.as_string()) return text->get();
  if (node.is_number()) return *node.value<double>();
  const toml::array* items = node.as_array();
  if (!items) return {};
  std::vector<double> numbers;
  for (const toml::node& item : *items) {
    if (!item.is_number()) return {};
    numbers.push_back(*item.value<double>());
  }
  return numbers;
}

/// Keys whose value is a path that means the same wherever a program is started.
bool IsPlace(std::string_view key) {
  return key == "socket" || key == "output_dir" || key == "models_dir";
}

struct Reader {
  const std::string& path;
  DaemonConfig* config;
  ProblemList problems = {};

  std::string Place(const toml::node& node) const {
    return fmt::format("{}:{}", path, node.source().begin.line);
  }
  [[noreturn]] void Fail(const toml::node& node, const std::string& message) const {
    throw ConfigError(fmt::format("{}: {}", Place(node), message));
  }

  void ReadParameter(const std::string& name, const toml::node& node) const {
    const int index = FindParameter(name);
    if (index < 0) {
      std::vector<std::string_view> names;
      for (const ParameterInfo& info : ParameterTable()) names.push_back(info.name);
      Fail(node, fmt::format("unknown parameter '{}'{}", name, OrNearest(name, names)));
    }
    const ParameterInfo& info = ParameterTable()[static_cast<std::size_t>(index)];
    const std::optional<GivenValue> given = Given(node);
    if (!given)
      Fail(node, fmt::format("{} = {}: expected {}", name, Written(node), AllowedText(info)));
    Vector3d value;
    try {
      value = ReadParameterValue(info, *given);
    } catch (const ParameterError& e) {
      Fail(node, WithHint(e.what(), e.hint));
    }
    config->parameters.emplace_back(name, value);
    config->origins["parameters." + name] = Place(node);
  }

  /// Keeps what is wrong with one value, so that the reader hears of all at once.
  template <typename Read>
  void Try(const toml::node& node, const Read& read) {
    try {
      read();
    } catch (const ConfigError& error) {
      problems.Add(static_cast<int>(node.source().begin.line), error.what());
    }
  }

  /// [parameters] may be written with quoted names, dotted keys or sub-tables.
  void ReadParameters(const toml::table& table, const std::string& prefix) {
    for (const auto& [key, node] : table) {
      const std::string name = prefix + std::string(key.str());
      if (const toml::table* inner = node.as_table())
        ReadParameters(*inner, name + ".");
      else
        Try(node, [&, &value = node] { ReadParameter(name, value); });
    }
  }

  void ReadKey(const ConfigKey& key, const toml::node& node) const {
    const auto wrong = [&](const char* expected) {
      Fail(node, fmt::format("{} = {}: expected {}", key.name, Written(node), expected));
    };
    std::string text;
    if (key.kind == KeyKind::kInteger) {
      if (!node.is_integer()) wrong("an integer");
      text = std::to_string(*node.value<std::int64_t>());
    } else if (key.kind == KeyKind::kBool) {
      if (!node.is_boolean()) wrong("true or false");
      text = *node.value<bool>() ? "true" : "false";
    } else if (key.kind == KeyKind::kSpeed && node.is_number()) {
      text = fmt::format("{}", *node.value<double>());
    } else {
      if (!node.is_string())
        wrong(key.kind == KeyKind::kSpeed ? "a number, or \"max\"" : "a string");
      text = HomeExpanded(*node.value<std::string>());
      if (IsPlace(key.name) && !text.empty() && !text.starts_with('/'))
        wrong(text.starts_with("~/") ? "$HOME to be set to an absolute path"
                                     : "an absolute path, or one that begins with ~/");
    }
    SetKey(config, key, text, Place(node));
  }

  void ReadEntry(std::string_view name, const toml::node& node) {
    if (name == "parameters") {
      const toml::table* table = node.as_table();
      if (!table) Fail(node, "parameters is a table");
      return ReadParameters(*table, "");
    }
    const auto key = std::ranges::find(ConfigKeys(), name, &ConfigKey::name);
    if (key == ConfigKeys().end()) {
      std::vector<std::string_view> names = {"parameters"};
      for (const ConfigKey& known : ConfigKeys()) names.push_back(known.name);
      Fail(node, fmt::format("unknown key '{}'{}", name, OrNearest(name, names)));
    }
    ReadKey(*key, node);
  }

  void Read(const toml::table& root) {
    for (const auto& [name, node] : root)
      Try(node, [&, &key = name, &value = node] { ReadEntry(key.str(), value); });
    if (!problems.empty()) throw ConfigError(problems);
  }
};

/// As TOML writes it.
std::string TomlText(const ParameterInfo& info, const Vector3d& value) {
  const std::string text = ParameterText(info, value);
  return info.type == ParameterType::kWord ? "\"" + text + "\"" : text;
}

Json Value(const ConfigKey& key, const DaemonConfig& config) {
  const std::string text = key.get(config);
  if (key.kind == KeyKind::kInteger) return std::stoll(text);
  if (key.kind == KeyKind::kBool) return text == "true";
  if (key.kind == KeyKind::kSpeed && text != "max") return ParseSpeed(text);
  return text;
}

}  // namespace

void ReadConfigFile(const std::string& path, DaemonConfig* config) {
  if (::access(path.c_str(), F_OK) != 0 && (errno == ENOENT || errno == ENOTDIR))
    throw ConfigNotFound(fmt::format("{}: no such file", path));
  if (::access(path.c_str(), R_OK) != 0) throw ConfigError(fmt::format("{}: cannot be read", path));
  std::string text;
  try {
    text = ReadTomlText(path);
  } catch (const std::runtime_error& error) {
    throw ConfigError(error.what());
  }
  try {
    Reader{path, config}.Read(toml::parse(text));
  } catch (const toml::parse_error& e) {
    throw ConfigError(fmt::format("{}:{}: {}", path, e.source().begin.line, e.description()));
  }
  config->file = path;
}

DaemonConfig ResolveConfig(const ConfigFlags& flags) {
  DaemonConfig config;
  const std::string file = flags.file.empty() ? UsualConfigFile() : flags.file;
  if (!file.empty()) ReadConfigFile(file, &config);
  for (const ConfigKey& key : ConfigKeys()) {
    const std::string variable = VariableOf(key);
    const char* text = std::getenv(variable.c_str());
    if (text != nullptr && *text != '\0') SetKey(&config, key, text, "$" + variable);
  }
  for (const auto& [name, text] : flags.set) {
    const ConfigKey& key = *std::ranges::find(ConfigKeys(), name, &ConfigKey::name);
    SetKey(&config, key, text, FlagOf(key));
  }
  return config;
}

std::string DefaultConfigText() {
  const DaemonConfig config;
  std::string text = "# Configuration of regraspd: every key with its built-in value.\n\n";
  for (const ConfigKey& key : ConfigKeys()) {
    const std::string value = key.get(config);
    text += fmt::format("{} = {}  # {}\n", key.name,
                        key.kind == KeyKind::kText ? fmt::format("\"{}\"", value) : value,
                        key.sentence);
  }
  text +=
      "\n# Parameters of the simulation and the controller. Mass, friction and gravity come from "
      "the\n"
      "# models unless they are set here.\n[parameters]\n";
  Parameters parameters;
  for (const ParameterInfo& info : ParameterTable()) {
    text += fmt::format("# \"{}\" = {}  # {} {}\n", info.name, TomlText(info, info.get(parameters)),
                        info.meaning, AllowedText(info));
  }
  return text;
}

std::string ConfigJson(const DaemonConfig& config) {
  const auto origin = [&](const std::string& name, const char* otherwise) -> std::string {
    const auto it = config.origins.find(name);
    return it == config.origins.end() ? otherwise : it->second;
  };
  Json keys = Json::array(), parameters = Json::array();
  for (const ConfigKey& key : ConfigKeys())
    keys.push_back({{"name", key.name},
                    {"value", Value(key, config)},
                    {"origin", origin(std::string(key.name), "built in")},
                    {"variable", VariableOf(key)},
                    {"flag", FlagOf(key)},
                    {"reload", key.live},
                    {"description", key.sentence}});
  Parameters built_in;
  for (const ParameterInfo& info : ParameterTable()) {
    Vector3d shown = info.get(built_in);
    for (const auto& [name, set] : config.parameters)
      if (name == info.name) shown = set;
    const std::string from = origin("parameters." + std::string(info.name), "");
    const bool of_model = info.name == "gravity" || info.name.starts_with("object.");
    Json json = ParameterValueJson(info, shown);
    if (from.empty() && of_model) json = nullptr;
    parameters.push_back({{"name", info.name},
                          {"value", std::move(json)},
                          {"origin", !from.empty() ? from
                                     : of_model    ? "model"
                                                   : "built in"},
                          {"unit", info.unit},
                          {"reload", true},
                          {"description", info.meaning}});
  }
  const Json file = config.file.empty() ? Json() : Json(config.file);
  return Json({{"file", file}, {"keys", std::move(keys)}, {"parameters", std::move(parameters)}})
      .dump();
}

}  // namespace regrasp
