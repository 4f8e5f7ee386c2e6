#pragma once

/// A run file in other formats.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/run/run_window.h"
#include "core/mcap/mcap_reader.h"

namespace regrasp::run {

struct ExportResult {
  std::uint64_t messages = 0, files = 0;
  bool complete = true;        ///< the input was
  std::vector<McapLoss> lost;  ///< what of the input could not be read
  std::string note;            ///< why it was executed from the start; see RunWindow
};

struct ExportOptions {
  std::string format, out;
  bool whole = true;  ///< every segment; false: the last segment's `stretch`
  Stretch stretch;
  double rate_hz = 0;  ///< more than 0: executed again and sampled so often; 0: as recorded
};

/// Called with the configuration of each run of the file, as it stands there, before what follows
/// is written.
using OnRun = std::function<void(std::string_view config)>;

/// `format`: csv (a directory with a file per topic), npz (an array per topic and field: float64
/// with NaN where a value is null, bool or text), mcap (a whole, indexed file, also from one whose
/// writer was killed; of a stretch the journal stays whole, so that it replays). Tables leave out
/// the topics for viewers and the saved states. `out` must not exist, and appears whole or not at
/// all. Throws std::runtime_error with path and cause: also for a file that holds no run, for names
/// of topics and fields that are no file names, and for a replay that differs.
ExportResult ExportRun(const std::string& path, const ExportOptions& options, const OnRun& on_run);

}  // namespace regrasp::run
