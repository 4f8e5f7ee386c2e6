#pragma once

/// The messages of a run at another rate, or of a time before it was recorded: by executing it
/// again.

#include <functional>

#include "cli/run/run_window.h"

namespace regrasp::run {

using OnMessage = std::function<void(const McapMessage&)>;

/// Configuration, scene, the stretch's commands and events, and every sampled topic at `rate_hz`
/// (at most one sample a tick). Throws std::runtime_error where the replay differs from the
/// recording.
void Resample(RunWindow* window, double rate_hz, const OnMessage& on_message);

}  // namespace regrasp::run
