#pragma once

/// Running another program, and reading what it prints.

#include <spawn.h>

#include <string>
#include <vector>

namespace regrasp::cli {

struct Finished {
  int code = 0;          ///< exit code; 128 + signal when it was killed
  std::string out, err;  ///< what it wrote
};

/// A program of ours that `regrasp` runs because it links what this one does not: beside it, or
/// installed in libexec. Throws CliError(kNotFound).
std::string FindHelper(const std::string& name);

/// Starts `words` (the first is looked for in $PATH), with no signal blocked whatever this program
/// waits for: Ctrl-C ends both. Throws CliError(kNotFound) when it cannot be started.
pid_t Start(const std::vector<std::string>& words,
            const posix_spawn_file_actions_t* actions = nullptr);
/// Waits for its end; its exit code, or 128 + signal when it was killed. Throws
/// CliError(kInterrupted) when that was SIGINT, the user's.
int WaitForEnd(pid_t pid);

/// Runs `words` (the first is looked for in $PATH) with no input and waits for its end. Throws
/// CliError(kNotFound) when it cannot be started, kInterrupted.
Finished RunProgram(const std::vector<std::string>& words);

}  // namespace regrasp::cli
