#pragma once

/// Jobs: waiting for them with progress, and printing their records.

#include <string>
#include <vector>

#include "cli/client/context.h"

namespace regrasp::cli {

/// What waiting does where simulated time stands still because it is paused.
enum class Standstill { kWait, kRefuse };

/// Waits until job `id` has ended and returns its record; shows one line of progress on a
/// terminal's stderr. Throws CliError: kTimeout after --timeout, kInterrupted (the job goes on),
/// with Standstill::kRefuse kRefused when the simulation is paused (the job waits).
Json WaitForJob(Context& context, std::int64_t id, Standstill standstill = Standstill::kWait);

/// kOk, or kFailed when the operation that the record tells of failed: job failed or cancelled,
/// exploration not converged, object dropped.
ExitCode JobExit(const Json& record);

/// A job of `status` in a few words: number, method, finger, state, how far.
std::string JobSummary(const Json& job);

/// The record, for people: one sentence, then what it measured.
void PrintJob(Context& context, const Json& record);

/// Sends the method of `invocation`, prints the job it started or, with --wait, its record.
ExitCode StartJob(Context& context, const Invocation& invocation);

/// `job list`, `show`, `wait`, `cancel`.
std::vector<CommandSpec> JobCommands();

}  // namespace regrasp::cli
