#pragma once

/// The messages of a run at another rate, or of a time before it was recorded: by executing it
/// again.

#include <functional>

#include "cli/run/run_window.h"

namespace regrasp::run {

using OnMessage = std::function<void(const McapMessage&)>;

/// Where the messages belong in the file that is made.
struct ResampledPlace {
  int segment = 0;
  std::uint64_t offset_ns = 0;  ///< of its tick 0
};

/// Configuration, scene, the stretch's commands and events, and every sampled topic at `rate_hz`.
/// Throws CliError(kUsage) for more samples than ticks, std::runtime_error where the replay differs
/// from the recording.
void Resample(RunWindow* window, double rate_hz, const ResampledPlace& place,
              const OnMessage& on_message);

}  // namespace regrasp::run
