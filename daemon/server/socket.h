#pragma once

/// The listening socket in the file system (docs/protocol.md: Access).

#include <stdexcept>
#include <string>

#include "core/protocol/errors.h"

namespace regrasp {

/// Why a socket cannot be made; `exit_code()` is what regraspd ends with.
class SocketError : public std::runtime_error {
 public:
  SocketError(ExitCode exit_code, const std::string& message)
      : std::runtime_error(message), exit_code_(exit_code) {}
  ExitCode exit_code() const { return exit_code_; }

 private:
  ExitCode exit_code_;
};

/// A Unix stream socket that listens at a path, and the lock that makes this process its only
/// owner.
class ListenSocket {
 public:
  /// Makes the directory (0700) when it is missing, takes the lock PATH.lock, removes a socket
  /// nobody listens on any more, binds (0600) and listens. Throws SocketError: a distrusted
  /// directory, another daemon, something at the path that is not a socket (left alone), a path of
  /// more than 107 bytes.
  explicit ListenSocket(const std::string& path);
  /// Takes over a socket that listens already (socket activation). It has no lock, and its file
  /// stays: both belong to whoever made it.
  explicit ListenSocket(int listening);
  /// Remove().
  ~ListenSocket();
  ListenSocket(const ListenSocket&) = delete;
  ListenSocket& operator=(const ListenSocket&) = delete;

  /// Gives the descriptor away.
  int Release();
  /// Removes the socket from the file system, if it is still the one made here. The lock stays
  /// until destruction.
  void Remove();
  const std::string& path() const { return path_; }
  /// True when it was taken over.
  bool inherited() const { return inherited_; }

 private:
  void Lock();
  void RemoveStale();
  void Bind();

  std::string path_;
  int lock_ = -1;
  int socket_ = -1;
  bool bound_ = false, inherited_ = false;
  unsigned long long device_ = 0, inode_ = 0;
};

/// True when the process at the other end of the connected socket `fd` runs as this user or as
/// root.
bool PeerAllowed(int fd);

/// True when the other end of the connected socket `fd` is closed in both directions.
bool PeerGone(int fd);

}  // namespace regrasp
