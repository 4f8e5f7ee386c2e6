#pragma once

/// What decides the results of a case, beside the plan: models, parameters, program.

#include "cli/experiment/plan.h"
#include "cli/experiment/stepped_daemon.h"

namespace regrasp::cli {

/// Writes down what `daemon`, prepared for the case, tells of itself: into Plan::models and
/// Plan::parameters.
void AddIdentity(SteppedDaemon* daemon, std::size_t which, Plan* plan);

/// Throws CliError(kRefused) that names the model or program where `daemon`, prepared for the case,
/// is not what was written down: a model's file or the daemon's program changed since.
void CheckIdentity(SteppedDaemon* daemon, std::size_t which, const Plan& plan);

}  // namespace regrasp::cli
