#include "core/files/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace regrasp {
namespace {

struct Descriptor {
  explicit Descriptor(int number) : fd(number) {}
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int fd;
};

[[noreturn]] void Fail(const std::string& path, const std::string& cause) {
  throw std::runtime_error("cannot read " + path + ": " + cause);
}

}  // namespace

std::string ReadRegularFile(const std::string& path, std::uint64_t max_bytes,
                            std::uint64_t only_first) {
  // Not blocking: opening a FIFO would wait for a writer.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (file.fd < 0) Fail(path, std::strerror(errno));
  struct stat info {};
  if (::fstat(file.fd, &info) != 0) Fail(path, std::strerror(errno));
  if (S_ISDIR(info.st_mode)) Fail(path, "it is a directory");
  if (!S_ISREG(info.st_mode)) Fail(path, "not a regular file");
  const auto size = std::min(static_cast<std::uint64_t>(info.st_size), only_first);
  if (size > max_bytes)
    Fail(path, std::to_string(size) + " bytes; at most " + std::to_string(max_bytes) + " are read");
  std::string text(size, '\0');
  std::size_t have = 0;
  while (have < text.size()) {
    const ssize_t got = ::read(file.fd, text.data() + have, text.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) Fail(path, std::strerror(errno));
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  text.resize(have);
  return text;
}

}  // namespace regrasp
