#pragma once

/// Jobs: waiting for them with progress, and printing their records.

#include "cli/client/context.h"

namespace regrasp::cli {

/// Waits until job `id` has ended and returns its record; shows one line of progress on a
/// terminal's stderr. Throws CliError: kTimeout after --timeout, kInterrupted (the job goes on).
Json WaitForJob(Context& context, std::int64_t id);

/// kOk, or kFailed when the operation that the record tells of failed: job failed or cancelled,
/// exploration not converged, object dropped.
ExitCode JobExit(const Json& record);

/// The record, for people: one sentence, then what it measured.
void PrintJob(Output& out, const Json& record);

/// Throws CliError(kRefused), with `next` to try, when the simulation is paused: `what` would wait
/// until somebody else lets it go on.
void CheckNotPaused(Context& context, const std::string& what, const std::string& next);

/// Sends the method of `invocation`, prints the job it started or, with --wait, its record.
ExitCode StartJob(Context& context, const Invocation& invocation);

}  // namespace regrasp::cli
