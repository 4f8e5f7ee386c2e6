#pragma once

/// Where a user's files are: one rule for both programs.

#include <string>

namespace regrasp {

/// $NAME where it is an absolute path, else "": the XDG specification has relative ones ignored.
std::string DirectoryVariable(const char* name);

/// $XDG_CONFIG_HOME, else ~/.config; "" without a home.
std::string ConfigHome();
/// $XDG_STATE_HOME, else ~/.local/state; "" without a home.
std::string StateHome();

/// Where a daemon writes that was told nothing else: `regrasp` in StateHome(), else
/// /tmp/regrasp-$UID/output.
std::string DefaultOutputDir();

/// A path as a file names it: `~` at its beginning, alone or before a slash, is $HOME.
std::string HomeExpanded(const std::string& path);

}  // namespace regrasp
