#pragma once

/// `regrasp bench`: what a tick and a request cost on this machine.

#include "cli/client/context.h"

namespace regrasp::cli {

ExitCode Bench(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
