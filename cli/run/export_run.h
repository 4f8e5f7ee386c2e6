#pragma once

/// A run file in other formats.

#include <string>

namespace regrasp::run {

struct ExportResult {
  std::uint64_t messages = 0, files = 0;
  bool complete = true;  ///< the input was
};

/// `format`: csv (a directory with a file per topic), npz (an array per topic and field: float64,
/// bool or text), mcap (a whole, indexed file, also from one whose writer was killed). `out` must
/// not exist. Throws std::runtime_error with path and cause.
ExportResult ExportRun(const std::string& path, const std::string& format, const std::string& out);

}  // namespace regrasp::run
