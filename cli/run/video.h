#pragma once

/// A film of a run, made by re-executing it: the scene, and curves below.

#include <functional>
#include <string>

#include "cli/run/run_window.h"

namespace regrasp::run {

inline constexpr double kCurveWindow_s = 10;  ///< seconds that the curves show

struct VideoOptions {
  double fps = 25;   ///< pictures per second of film
  double speed = 1;  ///< seconds of the run per second of film
  Stretch stretch;
  bool scene_only = false;  ///< no curves
};

struct VideoResult {
  int frames = 0;
  double duration_s = 0;     ///< of the film
  std::string codec;         ///< "H.264" or "GIF"
  bool interrupted = false;  ///< nothing was left behind
};

/// Told how many of how many pictures are done; false: stop.
using OnPicture = std::function<bool(int done, int total)>;

/// Of the last segment. The suffix of `out` chooses: .mp4 is H.264 (yuv420p) with its index in
/// front, .gif is animated, half as large. `window` begins no later than the curves. Throws
/// std::runtime_error: nothing to show, the replay differs from what was recorded, no encoder, a
/// file that cannot be written.
VideoResult WriteVideo(RunWindow* window, const VideoOptions& options, const std::string& out,
                       const OnPicture& on_picture);

}  // namespace regrasp::run
