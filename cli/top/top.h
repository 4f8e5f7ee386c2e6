#pragma once

#include "cli/client/context.h"

namespace regrasp::cli {

/// The full-screen dashboard; see INTERFACE.md.
ExitCode Top(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
