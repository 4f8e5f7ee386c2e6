#pragma once

/// The whole daemon in one object, for main() and for tests in one process.

#include <memory>
#include <string>

#include "daemon/config.h"

namespace regrasp {

class ListenSocket;
class Server;
struct Limits;

class Daemon {
 public:
  /// Loads the models, takes the socket, builds the session. Throws ConfigError, ModelError,
  /// SocketError, std::filesystem::filesystem_error. `limits` overrides the limits on clients.
  explicit Daemon(const DaemonConfig& config, const Limits* limits = nullptr);
  ~Daemon();

  /// Serves until Stop(), a shutdown request or (with `signals`) SIGINT or SIGTERM.
  void Run(bool signals);
  /// Any thread.
  void Stop();
  const std::string& socket_path() const;

 private:
  std::unique_ptr<ListenSocket> listener_;
  std::unique_ptr<Server> server_;
};

/// What `--check-config` checks: models load, and session and models fit. Throws as Daemon does.
void CheckModels(const DaemonConfig& config);

}  // namespace regrasp
