#pragma once

/// The commands `param ...`.

#include <string>
#include <vector>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

std::vector<CommandSpec> ParameterCommands();

/// "gait.mode = exploring, gait.hop = false" of an answer's {NAME: value}; "" when there is none.
std::string ChangedText(const Json& changed);

}  // namespace regrasp::cli
