#pragma once

/// Waiting that signals can end, without races.

#include <poll.h>

#include <chrono>
#include <span>

namespace regrasp::cli {

using Clock = std::chrono::steady_clock;

/// The time `seconds` from now; a huge value (a year) when `seconds` is 0 or less: no limit.
Clock::time_point Deadline(double seconds);

/// While an Interruptible lives, SIGINT, SIGTERM, SIGHUP and SIGQUIT no longer kill the program:
/// the wait in progress, or the next one, throws CliError(kInterrupted) instead. An
/// ignored SIGHUP stays so.
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

/// Waits until one of `fds` is ready (its `revents` says for what), the deadline has passed, or a
/// signal with another handler came (a new window size). Throws CliError(kInterrupted).
void WaitForAny(std::span<pollfd> fds, Clock::time_point deadline);

/// The signal that came since the outermost living Interruptible was made, 0 when none did.
int SignalReceived();
/// Throws CliError(kInterrupted) if a signal came since the outermost living Interruptible was
/// made.
void CheckInterrupt();

}  // namespace regrasp::cli
