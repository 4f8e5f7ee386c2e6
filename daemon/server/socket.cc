#include "daemon/server/socket.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "core/protocol/socket_path.h"

namespace regrasp {
namespace {

[[noreturn]] void Fail(const std::string& what, int error) {
  const bool permission = error == EACCES || error == EPERM || error == EROFS;
  throw SocketError(permission ? ExitCode::kPermission : ExitCode::kIo,
                    fmt::format("{}: {}", what, std::strerror(error)));
}

sockaddr_un Address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

void MakeDirectory(const std::string& socket) {
  const std::filesystem::path directory = std::filesystem::path(socket).parent_path();
  if (directory.empty()) return;
  if (::mkdir(directory.c_str(), 0700) != 0 && errno != EEXIST)
    Fail(fmt::format("cannot make the directory {}", directory.string()), errno);
  if (const std::string cause = DistrustedDirectory(socket); !cause.empty())
    throw SocketError(ExitCode::kPermission, cause);
}

}  // namespace

ListenSocket::ListenSocket(const std::string& path) : path_(path) {
  if (path_.empty() || path_.size() >= sizeof(sockaddr_un::sun_path))
    throw SocketError(ExitCode::kUsage,
                      fmt::format("socket path of {} bytes; allowed are 1 to {}: {}", path_.size(),
                                  sizeof(sockaddr_un::sun_path) - 1, path_));
  MakeDirectory(path_);
  try {
    Lock();
    RemoveStale();
    Bind();
  } catch (...) {
    Remove();
    if (socket_ >= 0) ::close(socket_);
    if (lock_ >= 0) ::close(lock_);
    throw;
  }
}

ListenSocket::ListenSocket(int listening) : socket_(listening), inherited_(true) {
  sockaddr_un address{};
  socklen_t size = sizeof address;
  if (::getsockname(listening, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    Fail("cannot look at the socket handed over", errno);
  const std::size_t length = size - offsetof(sockaddr_un, sun_path);
  path_.assign(address.sun_path, strnlen(address.sun_path, length));
}

ListenSocket::~ListenSocket() {
  Remove();
  if (socket_ >= 0) ::close(socket_);
  if (lock_ >= 0) ::close(lock_);
}

int ListenSocket::Release() { return std::exchange(socket_, -1); }

void ListenSocket::Lock() {
  const std::string lock = path_ + ".lock";
  lock_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock_ < 0) Fail(fmt::format("cannot open {}", lock), errno);
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) Fail(fmt::format("cannot lock {}", lock), errno);
    char holder[16] = {};
    const ssize_t size = ::pread(lock_, holder, sizeof holder - 1, 0);
    const long pid = size > 0 ? std::strtol(holder, nullptr, 10) : 0;
    throw SocketError(ExitCode::kRefused,
                      fmt::format("another daemon serves {}{}", path_,
                                  pid > 0 ? fmt::format(" (process {})", pid) : ""));
  }
  // For the next one to name us; nothing depends on it.
  const std::string pid = fmt::format("{}\n", ::getpid());
  if (::ftruncate(lock_, 0) != 0 || ::pwrite(lock_, pid.data(), pid.size(), 0) < 0) return;
}

void ListenSocket::RemoveStale() {
  struct stat info {};
  if (::lstat(path_.c_str(), &info) != 0) {
    if (errno == ENOENT) return;
    Fail(fmt::format("cannot look at {}", path_), errno);
  }
  if (!S_ISSOCK(info.st_mode))
    throw SocketError(ExitCode::kIo,
                      fmt::format("{} exists and is not a socket; left alone", path_));
  // No daemon of ours has the lock; but another program may listen.
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) Fail("cannot make a socket", errno);
  const sockaddr_un address = Address(path_);
  const int result = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const int error = result == 0 ? 0 : errno;
  ::close(probe);
  if (error == 0 || error == EAGAIN)
    throw SocketError(ExitCode::kRefused, fmt::format("another program listens on {}", path_));
  if (error != ECONNREFUSED) Fail(fmt::format("cannot probe {}", path_), error);
  if (::unlink(path_.c_str()) != 0)
    Fail(fmt::format("cannot remove the stale socket {}", path_), errno);
}

void ListenSocket::Bind() {
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) Fail("cannot make a socket", errno);
  // Bound sockets take the mode of their inode at bind(): fchmod first, so that 0600 holds from the
  // start.
  ::fchmod(socket_, 0600);
  const sockaddr_un address = Address(path_);
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    Fail(fmt::format("cannot bind {}", path_), errno);
  bound_ = true;
  struct stat info {};
  if (::lstat(path_.c_str(), &info) != 0) Fail(fmt::format("cannot look at {}", path_), errno);
  device_ = info.st_dev;
  inode_ = info.st_ino;
  if (::chmod(path_.c_str(), 0600) != 0) Fail(fmt::format("cannot protect {}", path_), errno);
  if (::listen(socket_, 128) != 0) Fail(fmt::format("cannot listen on {}", path_), errno);
}

void ListenSocket::Remove() {
  if (!std::exchange(bound_, false)) return;
  struct stat info {};
  const bool ours = ::lstat(path_.c_str(), &info) == 0 && S_ISSOCK(info.st_mode) &&
                    info.st_dev == device_ && info.st_ino == inode_;
  if (ours) ::unlink(path_.c_str());
}

bool PeerAllowed(int fd) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return false;
  return peer.uid == ::geteuid() || peer.uid == 0;
}

bool PeerGone(int fd) {
  pollfd descriptor{fd, 0, 0};
  return ::poll(&descriptor, 1, 0) == 1 && (descriptor.revents & (POLLHUP | POLLERR)) != 0;
}

}  // namespace regrasp
