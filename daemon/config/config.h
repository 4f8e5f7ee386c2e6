#pragma once

/// How regraspd is set up: built-in values, then the configuration file, then the environment, then
/// flags; the later wins.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/common/frames.h"
#include "core/files/problem_list.h"
#include "core/session/parameters.h"

namespace regrasp {

/// What is wrong with the configuration: file, line, key, value, what is allowed, the nearest name.
/// One line, or as ProblemList::Text() makes it.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(const std::string& message) : ConfigError(ProblemList(message)) {}
  explicit ConfigError(const ProblemList& problems) : std::runtime_error(problems.Text()) {}
};

/// There is no such configuration file.
class ConfigNotFound : public ConfigError {
 public:
  using ConfigError::ConfigError;
};

struct DaemonConfig {
  std::string socket;      ///< "": by rule, see core/protocol/socket_path.h
  std::string output_dir;  ///< "": by rule, see core/protocol/user_directories.h
  std::uint64_t seed = 1;
  std::string hand = "shadow";       ///< a name, or a .urdf file
  std::string object;                ///< a name, or a .urdf file; "": the scenario's
  std::string models_dir;            ///< searched first; "": only the usual places
  bool inertia_from_shape = false;   ///< LoadOptions
  bool force = false;                ///< LoadOptions
  bool fill_missing_meshes = false;  ///< LoadOptions
  std::string speed = "1.0";         ///< times real time, or "max"
  std::string clock = "continuous";  ///< continuous or lockstep
  bool paused = false;
  std::string noise = "paper";  ///< preset
  int max_clients = 64;
  // What is kept at most.
  int max_recording_mb = 4096;
  int max_incidents = 100, max_pictures = 500, max_checkpoints = 200;
  int max_commands = 200'000;
  std::string log_level = "info";   ///< trace debug info warn error off
  std::string log_format = "text";  ///< text or json
  std::string stepper = "auto";     ///< fast, exact, round or auto
  /// Values for the parameter table, in the order they were set.
  std::vector<std::pair<std::string, Vector3d>> parameters;
  /// Where the values that are not built in come from: "FILE:LINE", "$REGRASP_SEED", "--seed"; by
  /// key, or "parameters.NAME".
  std::map<std::string, std::string> origins;
  std::string file;  ///< the configuration file that was read; "": none
};

enum class KeyKind : std::uint8_t { kText, kInteger, kBool, kSpeed };

/// One key: `max_clients` in the file, $REGRASP_MAX_CLIENTS, --max-clients.
struct ConfigKey {
  std::string_view name;
  std::string_view metavar;   ///< "N"; "" for kBool
  std::string_view sentence;  ///< what it means
  KeyKind kind;
  std::string (*get)(const DaemonConfig&);
  void (*set)(DaemonConfig&, const std::string&);
  bool live = false;        ///< a reload changes it; otherwise it needs a restart
  double min = 0, max = 0;  ///< kInteger, inclusive
};

/// Every key, in the order they are printed.
std::span<const ConfigKey> ConfigKeys();
std::string FlagOf(const ConfigKey& key);      ///< "--max-clients"
std::string VariableOf(const ConfigKey& key);  ///< "REGRASP_MAX_CLIENTS"

/// Gives a key the value that `text` says. Throws ConfigError; `origin` names where it stands.
void SetKey(DaemonConfig* config, const ConfigKey& key, const std::string& text,
            const std::string& origin);

/// What the command line asks for.
struct ConfigFlags {
  std::string file;                                      ///< --config; "": the usual places
  std::vector<std::pair<std::string, std::string>> set;  ///< key name and text
};

/// File, environment and flags together. Throws ConfigError.
DaemonConfig ResolveConfig(const ConfigFlags& flags);

/// Reads a configuration file (TOML) over `config`. Throws ConfigError; unknown keys are errors.
void ReadConfigFile(const std::string& path, DaemonConfig* config);

/// Checks what does not depend on models: ranges, words. `where` begins the message. Throws
/// ConfigError.
void CheckConfig(const DaemonConfig& config, const std::string& where);

/// `text` as a speed factor; kMaxSpeed for "max". Throws ConfigError.
double ParseSpeed(const std::string& text);

/// The text of a configuration file that holds every key with its built-in value.
std::string DefaultConfigText();

/// What is in force and where it comes from, as one JSON object: file, keys and parameters, each
/// {name, value, origin, description, unit, reload}.
std::string ConfigJson(const DaemonConfig& config);

}  // namespace regrasp
