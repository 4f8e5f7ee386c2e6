#pragma once

/// One unit of an experiment, on a daemon of its worker. Each job begins in the tick after the end
/// of the one before, as in bench/zoo.cc: the same seed and settings give the same turn. What a
/// trial is:
///  exploration: new run with the seed, grasp, explore with the seed as that of the start gradient,
///               hold for one second.
///  rotation:    new run with the seed, grasp, rotate; pushed each second when the plan
///               says so, for 0.1 s, in a direction drawn from the seed.

#include "cli/experiment/plan.h"
#include "cli/experiment/stepped_daemon.h"

namespace regrasp::cli {

/// Noise-free phi at the end of a success: at least this share of the best within reach.
inline constexpr double kSuccessShare = 0.95;

/// Sets the parameters of one case, for all runs to come, on a daemon started with
/// Plan::DaemonArguments(which). Throws CliError as the daemon refuses them.
void Prepare(SteppedDaemon* daemon, const Plan& plan, std::size_t which = 0);

/// Runs the unit, on a daemon prepared for its case.
UnitResult RunUnit(SteppedDaemon* daemon, const Plan& plan, const Unit& unit);

}  // namespace regrasp::cli
