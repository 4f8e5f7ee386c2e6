#pragma once

/// Bytes of an MCAP file: off the disk piece by piece, and numbers and strings off the bytes. For
/// this folder only.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "core/mcap/mcap_reader.h"

namespace regrasp::mcap {

/// Reads numbers and strings off the front; `ok` turns false at the end of the data.
struct Cursor {
  std::string_view data;
  bool ok = true;
  std::string_view Take(std::uint64_t size) {
    if (size > data.size()) {
      ok = false;
      return {};
    }
    const std::string_view taken = data.substr(0, size);
    data.remove_prefix(size);
    return taken;
  }
  template <typename T>
  T Number() {
    const std::string_view bytes = Take(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
    return static_cast<T>(value);
  }
  std::string_view Text() { return Take(Number<std::uint32_t>()); }
  bool whole() const { return ok && data.empty(); }
};

inline std::uint32_t Crc(std::string_view data) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const Bytef*>(data.data()), data.size()));
}

/// A regular file, read piece by piece: it may be larger than the memory.
class File {
 public:
  explicit File(const std::string& path) : path_(path) {
    fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    struct stat info {};
    if (fd_ < 0 || ::fstat(fd_, &info) != 0) Refuse(std::strerror(errno));
    if (!S_ISREG(info.st_mode)) Refuse("not a regular file");
    size_ = static_cast<std::uint64_t>(info.st_size);
  }
  ~File() {
    if (fd_ >= 0) ::close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::uint64_t size() const { return size_; }
  /// Fewer bytes at the end of the file.
  std::string At(std::uint64_t offset, std::uint64_t size) const {
    std::string data(std::min(size, size_ - std::min(size_, offset)), '\0');
    std::size_t have = 0;
    while (have < data.size()) {
      const ssize_t got =
          ::pread(fd_, data.data() + have, data.size() - have, static_cast<off_t>(offset + have));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) Fail(std::strerror(errno));
      if (got == 0) break;
      have += static_cast<std::size_t>(got);
    }
    data.resize(have);
    return data;
  }

 private:
  /// In the constructor, after which nobody closes the file.
  [[noreturn]] void Refuse(const std::string& cause) const {
    if (fd_ >= 0) ::close(fd_);
    Fail(cause);
  }
  [[noreturn]] void Fail(const std::string& cause) const {
    throw McapError("cannot read " + path_ + ": " + cause);
  }
  const std::string& path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace regrasp::mcap
