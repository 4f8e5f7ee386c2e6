#pragma once

/// Running another program, and reading what it prints.

#include <sys/types.h>

#include <string>
#include <vector>

#include "cli/client/errors.h"

namespace regrasp::cli {

struct Finished {
  int code = 0;          ///< exit code; 128 + signal when it was killed
  std::string out, err;  ///< what it wrote
};

/// A program of ours that `regrasp` runs because it links what this one does not: beside it, or
/// installed in libexec. Throws CliError(kNotFound).
std::string FindHelper(const std::string& name);

/// Where a program writes instead of to standard output and standard error; -1: there. It gets no
/// input then.
struct Pipes {
  int out = -1, err = -1;
};

/// Starts `words` (the first is looked for in $PATH), with no signal blocked whatever this program
/// waits for: Ctrl-C ends both. It gets SIGTERM when this program ends, however that does. Throws
/// CliError(kNotFound) when it cannot be started.
pid_t Start(const std::vector<std::string>& words, const Pipes& pipes = {});
/// Waits for its end; its exit code, or 128 + signal when it was killed. Throws
/// CliError(kInterrupted) when it or this program was interrupted; it has ended then, too.
int WaitForEnd(pid_t pid);
/// Runs a helper to its end; its exit code. When it is interrupted, what it has begun beside
/// `output` goes. Throws CliError: kInterrupted, kFailed when a signal ended it.
ExitCode RunHelper(const std::vector<std::string>& words, const std::string& output = "");

/// Runs `words` (the first is looked for in $PATH) with no input and waits for its end. Throws
/// CliError(kNotFound) when it cannot be started, kInterrupted.
Finished RunProgram(const std::vector<std::string>& words);

}  // namespace regrasp::cli
