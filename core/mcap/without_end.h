#pragma once

#include <string>

namespace regrasp {

/// All that is known of a run file without an end.
inline constexpr const char* kWhyWithoutEnd =
    "it is being written elsewhere, its writer was killed, or it was cut";

/// "FILE has no end: …", of a run file as it is called.
inline std::string WithoutEndText(const std::string& file) {
  return file + " has no end: " + kWhyWithoutEnd;
}

}  // namespace regrasp
