#pragma once

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// `hand check`, `hand new`.
std::vector<CommandSpec> HandCommands();

}  // namespace regrasp::cli
