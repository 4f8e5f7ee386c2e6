#pragma once

/// One unit of an experiment, on a daemon of its worker. What a trial is:
///  exploration: new run with the seed, grasp, explore with the seed as that of the start gradient,
///               hold for one second. As in `claims explore` of bench/.
///  rotation:    new run with the seed, grasp, rotate.

#include "cli/experiment/plan.h"
#include "cli/experiment/stepped_daemon.h"

namespace regrasp::cli {

/// Noise-free phi at the end of a success: at least this share of the best within reach.
inline constexpr double kSuccessShare = 0.95;

/// Sets the plan's parameters, for all runs to come. Throws CliError as the daemon refuses them.
void Prepare(SteppedDaemon* daemon, const Plan& plan);

/// Runs the unit.
UnitResult RunUnit(SteppedDaemon* daemon, const Plan& plan, const Unit& unit);

}  // namespace regrasp::cli
