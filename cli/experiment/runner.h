#pragma once

/// Runs what is left of an experiment: a thread and a daemon for each worker.

#include "cli/client/context.h"
#include "cli/experiment/store.h"

namespace regrasp::cli {

/// Runs the units of `plan` that `store` does not have yet, on `workers` daemons, and keeps each as
/// it finishes. Shows progress on stderr: a bar on a terminal, else a line for each unit; nothing
/// with -q. Throws the first CliError of any worker; what had finished is kept.
void RunPlan(Context& context, const Plan& plan, int workers, Store* store);

}  // namespace regrasp::cli
