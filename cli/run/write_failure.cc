#include "cli/run/write_failure.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace regrasp::run {

std::string WhyNotWritten(const std::string& path) {
  const std::string some(1 << 16, '\0');
  const int fd = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  std::string cause = fd < 0 ? std::strerror(errno) : "";
  // A write that has room for a part succeeds; the next one does not.
  for (int k = 0; k < 2 && cause.empty(); ++k)
    if (::write(fd, some.data(), some.size()) < 0) cause = std::strerror(errno);
  if (fd >= 0) ::close(fd);
  return cause;
}

void FailToWrite(const std::string& path) {
  const std::string cause = WhyNotWritten(path);
  throw std::runtime_error("cannot write " + path + (cause.empty() ? "" : ": " + cause));
}

}  // namespace regrasp::run
