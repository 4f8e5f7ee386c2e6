#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace regrasp {

/// The suffix of a file's name, lower case: ".png" of "A.PNG"; "" where it has none.
inline std::string LowerSuffix(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::ranges::transform(suffix, suffix.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix;
}

}  // namespace regrasp
