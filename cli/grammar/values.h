#pragma once

/// What is typed for an argument, as the wire takes it.

#include <string>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// As it is called in an error: "--angle", or "FINGER" where it has no flag.
std::string ArgName(const Arg& arg);

/// The value of `text`: units converted, words and ranges checked. Throws CliError(kUsage), with a
/// hint where one of the words of `scope`'s command is near.
Json ToWire(const Arg& arg, const std::string& text, const std::string& scope);

}  // namespace regrasp::cli
