#pragma once

#include <vector>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// `events` and `watch`: what the daemon sends as it comes.
std::vector<CommandSpec> WatchCommands();

}  // namespace regrasp::cli
