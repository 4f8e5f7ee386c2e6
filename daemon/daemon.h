#pragma once

/// The whole daemon in one object, for main() and for tests in one process.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/config/config.h"

namespace regrasp {

class ListenSocket;
struct SessionConfig;
class Server;
struct Limits;

class Daemon {
 public:
  /// Loads the models, takes the socket, builds the session. Throws ConfigError, ModelError,
  /// SocketError, std::filesystem::filesystem_error. `limits` overrides the limits on clients.
  explicit Daemon(const DaemonConfig& config, const Limits* limits = nullptr);
  ~Daemon();

  /// Makes the configuration anew from file, environment and flags. Throws ConfigError.
  using ConfigSource = std::function<DaemonConfig()>;

  /// Serves until Stop(), a shutdown request or (with `signals`) SIGINT or SIGTERM. SIGHUP reloads
  /// from `source`: what can change at once does, what needs a restart is said in the log, and a
  /// configuration with an error changes nothing.
  void Run(bool signals, const ConfigSource& source = {});
  /// Any thread.
  void Stop();
  /// Stops as well when `fd` has no more to read. Before Run().
  void StopAtEndOf(int fd);
  const std::string& socket_path() const;

 private:
  void Reload(const ConfigSource& source);

  DaemonConfig config_;
  std::unique_ptr<ListenSocket> listener_;
  std::unique_ptr<Server> server_;
};

/// What the configuration makes of a session: models loaded, parameters set. Throws as Daemon does.
SessionConfig MakeSessionConfig(const DaemonConfig& config);

/// What `--check-config` checks: models load, and session and models fit. Gives the loaders'
/// warnings. Throws as Daemon does.
std::vector<std::string> CheckModels(const DaemonConfig& config);

}  // namespace regrasp
