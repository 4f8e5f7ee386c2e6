#pragma once

#include "cli/client/context.h"

namespace regrasp::cli {

/// `regrasp demo`: a private daemon at full speed grasps, explores with every finger, makes the two
/// runs of figure 2 with the ring finger, rotates, draws the pictures, and sets the paper's claims
/// beside what this run measured: a claim that misses is shown as MISSED. kFailed when the object
/// was dropped; throws when the grasp or a picture fails.
ExitCode Demo(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
