#pragma once

/// Files in the output directory.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace regrasp {

/// Makes the directory, has `write` make a draft beside `target` and renames it: a reader sees the
/// old file or the new one, and a symbolic link is replaced, not followed. The draft has the
/// target's suffix, and one suffix is written by one thread only: pictures by the worker, records
/// by the I/O thread. Returns the number of bytes. Throws what `write` throws and
/// std::filesystem::filesystem_error.
std::uintmax_t WriteOutput(const std::filesystem::path& target,
                           const std::function<void(const std::string& draft)>& write);

}  // namespace regrasp
