#pragma once

/// Where the configuration file is, and the names of its keys: one rule for both programs.

#include <array>
#include <string>
#include <string_view>

namespace regrasp {

/// What stands in it besides the table `parameters`; daemon/config/config_keys.cc has all about
/// them.
inline constexpr auto kConfigKeyNames = std::to_array<std::string_view>({"socket",
                                                                         "output_dir",
                                                                         "seed",
                                                                         "hand",
                                                                         "object",
                                                                         "models_dir",
                                                                         "inertia_from_shape",
                                                                         "force",
                                                                         "fill_missing_meshes",
                                                                         "speed",
                                                                         "clock",
                                                                         "paused",
                                                                         "noise",
                                                                         "max_clients",
                                                                         "max_recording_mb",
                                                                         "max_incidents",
                                                                         "max_pictures",
                                                                         "max_checkpoints",
                                                                         "max_commands",
                                                                         "log_level",
                                                                         "log_format",
                                                                         "stepper"});

/// $REGRASP_CONFIG; else the first that exists of $XDG_CONFIG_HOME/regrasp/regraspd.toml
/// (~/.config when it is not set) and /etc/regrasp/regraspd.toml; else "": none.
std::string UsualConfigFile();

}  // namespace regrasp
