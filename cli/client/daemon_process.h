#pragma once

/// Starting and stopping a private daemon.

#include <string>
#include <vector>

namespace regrasp::cli {

/// The `regraspd` beside this program, else the one in $PATH. Throws CliError(kNotFound).
std::string FindDaemon();

struct StartedDaemon {
  int pid = 0;
  std::string socket, log;
};

/// Starts `regraspd --socket socket arguments…` in the background, its output in a log file beside
/// the socket, and waits until it accepts connections. Makes the socket's directory (0700) if it is
/// missing. Throws CliError: with the end of the log when the daemon ends at once, kTimeout when it
/// is not ready after `timeout_s`.
StartedDaemon StartDaemon(const std::string& socket, const std::vector<std::string>& arguments,
                          double timeout_s);

/// Asks the daemon at `socket` to stop and waits until it is gone. Returns whether a service
/// manager keeps the socket and will start another at the next connection. Throws CliError.
bool StopDaemon(const std::string& socket, double timeout_s);

}  // namespace regrasp::cli
