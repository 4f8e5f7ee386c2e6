#pragma once

/// Files in the output directory.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/files/draft.h"

namespace regrasp {

/// Makes the directory, has `write` make a draft beside `target`, with its suffix, and renames it:
/// a reader sees the old file or the new one, and a symbolic link is replaced, not followed.
/// Returns the number of bytes. Throws what `write` and Draft throw.
std::uintmax_t WriteOutput(const std::filesystem::path& target, Draft::Existing existing,
                           const std::function<void(const std::string& draft)>& write);

}  // namespace regrasp
