#pragma once

/// Commands about run files and checkpoints. What needs the simulation or pictures is a program of
/// its own, regrasp-run.

#include <vector>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

std::vector<CommandSpec> CheckpointCommands();
std::vector<CommandSpec> RunFileCommands();

/// The run file: a path, or the name of one in the output directory of the daemon that answers.
/// Throws CliError(kNotFound).
std::string FindRun(Context& context, const std::string& name);

}  // namespace regrasp::cli
