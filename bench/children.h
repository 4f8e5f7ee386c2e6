#pragma once

/// Trials in several processes: a child that dies takes its trials with it, which must not pass for
/// trials that failed.

#include <sys/wait.h>

#include <stdexcept>
#include <string>

namespace regrasp {

/// Waits for every child of this process. Throws std::runtime_error where one did not end with 0.
inline void WaitForChildren() {
  std::string failed;
  int status = 0;
  for (pid_t child = wait(&status); child > 0; child = wait(&status)) {
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;
    failed = "process " + std::to_string(child) +
             (WIFSIGNALED(status) ? " was ended by signal " + std::to_string(WTERMSIG(status))
                                  : " ended with status " + std::to_string(WEXITSTATUS(status)));
  }
  if (!failed.empty()) throw std::runtime_error(failed + ": its trials are missing");
}

}  // namespace regrasp
