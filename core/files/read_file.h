#pragma once

/// Reading files that somebody else may have made.

#include <cstdint>
#include <string>

namespace regrasp {

/// The whole file, or its first `only_first` bytes. Throws std::runtime_error with path and cause:
/// not a regular file (a FIFO, a device, a directory: nothing is waited for), more than
/// `max_bytes`.
std::string ReadRegularFile(const std::string& path, std::uint64_t max_bytes,
                            std::uint64_t only_first = UINT64_MAX);

}  // namespace regrasp
