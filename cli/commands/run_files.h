#pragma once

/// Commands about run files and checkpoints. What needs the simulation or pictures is a program of
/// its own, regrasp-run.

#include <vector>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

std::vector<CommandSpec> CheckpointCommands();
std::vector<CommandSpec> RunFileCommands();

}  // namespace regrasp::cli
