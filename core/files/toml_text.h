#pragma once

/// TOML files that somebody else may have made.

#include <string>
#include <string_view>

namespace regrasp {

/// The text of a TOML file; of /dev/null none. Throws std::runtime_error with path and cause: what
/// ReadRegularFile refuses, more than 1 MiB, or a TomlFault.
std::string ReadTomlText(const std::string& path);

/// What a parser that recurses must not see, or "": a zero byte, brackets or the parts of a dotted
/// key nested deeper than any table of ours needs.
std::string TomlFault(std::string_view text);

}  // namespace regrasp
