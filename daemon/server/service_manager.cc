#include "daemon/server/service_manager.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>

#include "daemon/server/socket.h"

namespace regrasp {
namespace {

constexpr int kFirstInherited = 3;

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

std::optional<long long> Number(const char* name) {
  const std::string_view text = Environment(name);
  long long value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size()) return {};
  return value;
}

/// An option of a socket at level SOL_SOCKET, or -1.
int Option(int fd, int option) {
  int value = -1;
  socklen_t size = sizeof value;
  return ::getsockopt(fd, SOL_SOCKET, option, &value, &size) == 0 ? value : -1;
}

}  // namespace

ServiceManager::ServiceManager() {
  const std::string_view path = Environment("NOTIFY_SOCKET");
  const bool usable = path.size() > 1 && path.size() < sizeof address_.sun_path &&
                      (path[0] == '/' || path[0] == '@');
  if (usable) {
    address_.sun_family = AF_UNIX;
    std::memcpy(address_.sun_path, path.data(), path.size());
    if (path[0] == '@') address_.sun_path[0] = '\0';  // an abstract name
    address_size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  }
  const auto pid = Number("WATCHDOG_PID");
  const auto microseconds = Number("WATCHDOG_USEC");
  if (address_size_ != 0 && microseconds.value_or(0) > 0 && pid.value_or(::getpid()) == ::getpid())
    watchdog_ = std::chrono::microseconds(*microseconds);
}

void ServiceManager::Tell(std::string_view assignments) const {
  if (address_size_ == 0) return;
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return;
  ::sendto(fd, assignments.data(), assignments.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
           reinterpret_cast<const sockaddr*>(&address_), address_size_);
  ::close(fd);
}

int InheritedSocket() {
  if (Number("LISTEN_PID") != ::getpid()) return -1;
  const long long count = Number("LISTEN_FDS").value_or(0);
  if (count == 0) return -1;
  const auto refuse = [](const std::string& cause) {
    throw SocketError(ExitCode::kUsage, "socket activation: " + cause);
  };
  if (count != 1) refuse(fmt::format("{} sockets were handed over, expected 1", count));
  const int fd = kFirstInherited;
  if (Option(fd, SO_DOMAIN) != AF_UNIX || Option(fd, SO_TYPE) != SOCK_STREAM ||
      Option(fd, SO_ACCEPTCONN) != 1)
    refuse("descriptor 3 is no listening Unix stream socket (ListenStream=)");
  ::fcntl(fd, F_SETFD, FD_CLOEXEC);
  return fd;
}

}  // namespace regrasp
