#pragma once

/// Running another program and reading what it prints.

#include <string>
#include <vector>

namespace regrasp::cli {

struct Finished {
  int code = 0;          ///< exit code; 128 + signal when it was killed
  std::string out, err;  ///< what it wrote
};

/// Runs `words` (the first is looked for in $PATH) with no input and waits for its end. Throws
/// CliError(kNotFound) when it cannot be started, kInterrupted.
Finished RunProgram(const std::vector<std::string>& words);

}  // namespace regrasp::cli
