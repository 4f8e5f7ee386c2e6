#pragma once

#include "cli/client/context.h"

namespace regrasp::cli {

/// The full-screen dashboard; keys and panels: regrasp(1), top.
ExitCode Top(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
