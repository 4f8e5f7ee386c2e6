#pragma once

/// A film of a run, made by re-executing it: the scene, and curves below.

#include <string>

#include "cli/run/run_file.h"

namespace regrasp::run {

struct VideoOptions {
  double fps = 25;    ///< pictures per second of film
  double speed = 1;   ///< seconds of the run per second of film
  double from_s = 0;  ///< simulated time
  double to_s = 1e9;
};

struct VideoResult {
  int frames = 0;
  double duration_s = 0;  ///< of the film
};

/// Of the last segment. The suffix of `out` is .mp4. Throws std::runtime_error: nothing to show,
/// the replay differs from what was recorded, a file that cannot be written.
VideoResult WriteVideo(const RunFile& file, const VideoOptions& options, const std::string& out);

}  // namespace regrasp::run
