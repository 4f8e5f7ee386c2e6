#pragma once

/// What the claims share: their options, the session they ask for, means. Each is a file of its
/// own.

#include <string>
#include <vector>

#include "bench/settings.h"
#include "core/session/session.h"

namespace regrasp::claims {

struct Options {
  std::string what, hand = "shadow", noise = "paper", object;
  int seeds = 5, jobs = 2;
  std::uint64_t first = 1;
  double seconds = 60, tilt = -1, angle = 0, offset_mm = 0;
  std::string axis = "0,0,-1";
  bool exact = false, rows = false, reach = false, inertia_from_shape = false;
  std::vector<ParameterSetting> set;
};

/// First of a trial's numbers where the object was not even grasped.
inline constexpr double kFailed = -1;

/// The session of a trial. Throws ModelError and std::exception where the options are wrong.
SessionConfig MakeConfig(const Options& o, std::uint64_t seed, const std::string& object);

/// 0 of nothing.
double Mean(const std::vector<double>& v);
double Max(const std::vector<double>& v);

// Each prints what it measured and returns the exit code.
int Hold(const Options& o);
int Objects(const Options& o);
int Move(const Options& o);
int Repeat(const Options& o);

}  // namespace regrasp::claims
