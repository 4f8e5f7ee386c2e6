#pragma once

/// Waiting that SIGINT and SIGTERM can end, without races.

#include <chrono>

namespace regrasp::cli {

using Clock = std::chrono::steady_clock;

/// The time `seconds` from now; a huge value (a year) when `seconds` is 0 or less: no limit.
Clock::time_point Deadline(double seconds);

/// While an Interruptible lives, SIGINT and SIGTERM no longer kill the program: the wait in
/// progress, or the next one, throws CliError(kInterrupted) instead.
class Interruptible {
 public:
  Interruptible();
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;
};

/// Waits until `fd` is ready for `events` (poll's) and returns true, or false at the deadline.
/// With fd = -1 only waits. Throws CliError(kInterrupted).
bool WaitFor(int fd, short events, Clock::time_point deadline);

/// Throws CliError(kInterrupted) if a signal came while an Interruptible lived.
void CheckInterrupt();

}  // namespace regrasp::cli
