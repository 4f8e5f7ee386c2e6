#pragma once

/// `regrasp doctor`: is everything there that a daemon needs, and does the physics work here?

#include "cli/client/context.h"

namespace regrasp::cli {

ExitCode Doctor(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
