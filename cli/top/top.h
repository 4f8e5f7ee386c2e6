#pragma once

#include "cli/client/context.h"

namespace regrasp::cli {

/// The full-screen dashboard; its keys: cli/top/keys.h, its panels: panels.h.
ExitCode Top(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
