#pragma once

/// The one key of the configuration file that a client needs.

#include <string>

namespace regrasp::cli {

/// `socket` of the usual configuration file (core/protocol/config_path.h), or "". Throws
/// CliError(kUsage) with file and line when the file is not TOML, has
/// an unknown key or a `socket` that is no absolute path, kPermission when it cannot be
/// read.
std::string ConfiguredSocket();

}  // namespace regrasp::cli
