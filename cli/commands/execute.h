#pragma once

/// One command line, from words to exit code: for main() and for every line of the shell.

#include <string>
#include <vector>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// Parses `words` (without the program's name), runs the command and returns its exit code; errors
/// are printed, `where` ("script:3: ") before their cause. `defaults`: global options in force
/// where the words name none.
ExitCode Execute(const std::vector<std::string>& words, const GlobalOptions& defaults = {},
                 const std::string& where = "");

}  // namespace regrasp::cli
