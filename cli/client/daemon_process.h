#pragma once

/// Starting and stopping a private daemon.

#include <string>
#include <vector>

namespace regrasp::cli {

/// The `regraspd` beside this program, else the one in $PATH. Throws CliError(kNotFound).
std::string FindDaemon();

/// What a daemon may learn from where it is started.
enum class Surroundings {
  kOfUser,   ///< configuration file and environment, as the user has them
  kNothing,  ///< neither: no configuration file, no $REGRASP_..., no service manager; it ends with
             ///< this program
};

struct StartedDaemon {
  int pid = 0;
  std::string socket, log;
  int input = -1;  ///< the other end of its standard input, of a daemon that ends with this program
};

/// What `regraspd words... option` prints before it ends. Throws its error as CliError, with `next`
/// as the next command.
std::string AskDaemonProgram(std::vector<std::string> words, const std::string& option,
                             const std::string& next);

/// Starts `regraspd --socket socket arguments…` in the background, its output in a log file beside
/// the socket, and waits until it accepts connections. Makes the socket's directory (0700) if it is
/// missing. Throws CliError: with the end of the log when the daemon ends at once, kTimeout when it
/// is not ready after `timeout_s`.
StartedDaemon StartDaemon(const std::string& socket, const std::vector<std::string>& arguments,
                          double timeout_s, Surroundings surroundings = Surroundings::kOfUser);

/// Waits until no daemon holds the lock of `socket`: one that no longer listens may still be on its
/// way out. Returns false when one still does after `timeout_s`.
bool WaitForLock(const std::string& socket, double timeout_s);

/// Asks the daemon at `socket` to stop and waits until it is gone and another may start. Returns
/// whether a service manager keeps the socket and will start another at the next connection. Throws
/// CliError.
bool StopDaemon(const std::string& socket, double timeout_s);

}  // namespace regrasp::cli
