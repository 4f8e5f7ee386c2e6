#pragma once

#include "cli/client/context.h"

namespace regrasp::cli {

/// Commands one after the other: typed by a user, or read from FILE, or from standard input when
/// that is no terminal. Options: regrasp(1), shell.
ExitCode Shell(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
