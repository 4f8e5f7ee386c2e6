#pragma once

/// A run file in other formats.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mcap/mcap_reader.h"

namespace regrasp::run {

struct ExportResult {
  std::uint64_t messages = 0, files = 0;
  bool complete = true;        ///< the input was
  std::vector<McapLoss> lost;  ///< what of the input could not be read
};

/// Called with the configuration of each run of the file, as it stands there, before anything is
/// written.
using OnRun = std::function<void(std::string_view config)>;

/// `format`: csv (a directory with a file per topic), npz (an array per topic and field: float64,
/// bool or text), mcap (a whole, indexed file, also from one whose writer was killed). `out` must
/// not exist, and appears whole or not at all. Throws std::runtime_error with path and cause: also
/// for a file that holds no run, and for names of topics and fields that are no file names.
ExportResult ExportRun(const std::string& path, const std::string& format, const std::string& out,
                       const OnRun& on_run);

}  // namespace regrasp::run
