#pragma once

/// Where the configuration file is: one rule for both programs.

#include <string>

namespace regrasp {

/// $REGRASP_CONFIG; else the first that exists of $XDG_CONFIG_HOME/regrasp/regraspd.toml
/// (~/.config when it is not set) and /etc/regrasp/regraspd.toml; else "": none.
std::string UsualConfigFile();

}  // namespace regrasp
