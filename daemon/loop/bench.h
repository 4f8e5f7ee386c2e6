#pragma once

#include <string>

#include "daemon/config/config.h"

namespace regrasp {

/// Runs the configured session as fast as it can, `seconds` of wall clock in each state, and tells
/// what a tick costs: one JSON object, states {holding, exploring}, each {ticks, ticks_per_s, tick,
/// sense, control, collide, step: {median_s, p99_s}}. Throws what Session throws.
std::string Benchmark(const DaemonConfig& config, double seconds);

}  // namespace regrasp
