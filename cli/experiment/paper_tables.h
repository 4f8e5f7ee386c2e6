#pragma once

/// Tables of the reproduction report, Markdown, made from the summaries of its parts.

#include "cli/client/client.h"

namespace regrasp::cli {

/// "k/n (low–high %)", with Wilson's interval.
std::string Share(int k, int n);
/// The same for a count of a group of a summary.
std::string Share(const Json& group, const char* count);
/// The group of `summary` whose members are as `wanted`. Throws CliError(kFailed) without one.
const Json& GroupOf(const Json& summary, const Json& wanted);
/// The command that measures it again.
std::string CommandOf(const Json& summary);

/// A row for each finger and estimator.
std::string ExplorationTable(const Json& summary);
/// Noise and estimator down, fingers across: the share of `count`.
std::string SweepTable(const Json& summary, const char* count);
/// How the trials ended that were not done, for one finger or "all".
std::string OutcomeTable(const Json& summary, const std::string& finger);
/// A row for each case, axis or level of noise.
std::string RotationTable(const Json& summary);

}  // namespace regrasp::cli
