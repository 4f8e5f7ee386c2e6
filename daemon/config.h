#pragma once

/// How regraspd is set up: built-in values, then the configuration file, then the environment, then
/// flags; the later wins.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/common/frames.h"
#include "core/session/parameters.h"

namespace regrasp {

/// What is wrong with the configuration: file, line, key, value, what is allowed, the nearest name.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct DaemonConfig {
  std::string socket;      ///< "": by rule, see core/protocol/socket_path.h
  std::string output_dir;  ///< "": by rule, see DefaultOutputDir()
  std::uint64_t seed = 1;
  std::string hand = "shadow";  ///< a name, or a .urdf file
  std::string object;           ///< a name, or a .urdf file; "": the scenario's
  std::string models_dir;       ///< searched first; "": only the usual places
  std::string speed = "1.0";    ///< times real time, or "max"
  bool paused = false;
  std::string noise = "paper";  ///< preset
  int max_clients = 64;
  std::string log_level = "info";   ///< trace debug info warn error off
  std::string log_format = "text";  ///< text or json
  std::string stepper = "fast";     ///< fast or exact
  /// Values for the parameter table, in the order they were set.
  std::vector<std::pair<std::string, Vector3d>> parameters;
};

/// Reads a configuration file (TOML) over `config`. Throws ConfigError; unknown keys are errors.
void ReadConfigFile(const std::string& path, DaemonConfig* config);

/// Checks what does not depend on models: ranges, words. `where` begins the message. Throws
/// ConfigError.
void CheckConfig(const DaemonConfig& config, const std::string& where);

/// `text` as a speed factor; kMaxSpeed for "max". Throws ConfigError.
double ParseSpeed(const std::string& text);

/// The text of a configuration file that holds every key with its built-in value.
std::string DefaultConfigText();

/// $XDG_STATE_HOME/regrasp, else $HOME/.local/state/regrasp, else /tmp/regrasp-$UID/output.
std::string DefaultOutputDir();

}  // namespace regrasp
