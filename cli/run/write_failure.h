#pragma once

#include <string>

namespace regrasp::run {

/// Why nothing more can be written to a file, or "". Streams and video libraries do not tell: it is
/// what appending to the file meets now. For drafts that are thrown away.
std::string WhyNotWritten(const std::string& path);

/// Throws std::runtime_error "cannot write PATH: CAUSE".
[[noreturn]] void FailToWrite(const std::string& path);

}  // namespace regrasp::run
