#pragma once

/// Help and completion, made from the commands.

#include <string>

#include "cli/grammar/grammar.h"
#include "cli/print/print.h"

namespace regrasp::cli {

/// The list of commands for empty `words`, help on one command, or on a family ("noise"). Throws
/// CliError(kUsage) for unknown words.
std::string HelpText(const std::string& words, const Output& out);

/// What an argument is for, its values, range and default, in one line.
std::string MeaningOf(const Arg& arg);

/// A completion script for bash, zsh or fish.
std::string CompletionScript(const std::string& shell);

}  // namespace regrasp::cli
