#pragma once

/// The service manager (systemd), when it started this daemon: what it is told, its watchdog, the
/// socket it hands over. The protocols of sd_notify(3), sd_watchdog_enabled(3) and
/// sd_listen_fds(3). Without a manager everything here does nothing.

#include <sys/socket.h>
#include <sys/un.h>

#include <chrono>
#include <optional>
#include <string_view>

namespace regrasp {

class ServiceManager {
 public:
  /// Reads $NOTIFY_SOCKET, $WATCHDOG_USEC and $WATCHDOG_PID.
  ServiceManager();

  /// Sends assignments, one a line: "READY=1\nSTATUS=idle". Never blocks; what cannot be sent is
  /// lost.
  void Tell(std::string_view assignments) const;
  /// How long the manager waits for WATCHDOG=1 before it kills this process; empty: for ever.
  std::optional<std::chrono::microseconds> watchdog() const { return watchdog_; }

 private:
  sockaddr_un address_{};
  socklen_t address_size_ = 0;  ///< 0: nobody to tell
  std::optional<std::chrono::microseconds> watchdog_;
};

/// The listening socket that was handed over ($LISTEN_FDS, $LISTEN_PID), or -1. Throws SocketError
/// (usage) when there is more than one, or when it is no listening Unix stream socket.
int InheritedSocket();

}  // namespace regrasp
