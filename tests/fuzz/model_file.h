#pragma once

/// A file that holds fuzzed bytes, in memory.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace regrasp {

class ModelFile {
 public:
  ModelFile() : number_(::memfd_create("model", 0)) {
    if (number_ < 0) std::abort();
  }
  ~ModelFile() { ::close(number_); }
  ModelFile(const ModelFile&) = delete;
  ModelFile& operator=(const ModelFile&) = delete;

  void Write(const std::uint8_t* data, std::size_t size) {
    if (::ftruncate(number_, 0) != 0 ||
        ::pwrite(number_, data, size, 0) != static_cast<ssize_t>(size))
      std::abort();
  }
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(number_); }

 private:
  int number_;
};

}  // namespace regrasp
