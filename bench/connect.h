#pragma once

/// A connection to a daemon, for the programs here that time it.

#include <sys/socket.h>
#include <sys/un.h>

#include <cstdio>
#include <stdexcept>
#include <string>

namespace regrasp {

/// A connected socket, closed by whoever asked for it. Throws std::runtime_error: nobody listens.
inline int Connect(const std::string& path) {
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", path.c_str());
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("cannot connect to " + path);
  return fd;
}

}  // namespace regrasp
