#pragma once

#include <vector>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// `object show`.
std::vector<CommandSpec> ObjectCommands();

}  // namespace regrasp::cli
