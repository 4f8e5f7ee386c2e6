#pragma once

/// What the daemon's events tell about a run beyond the records of its jobs.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cli/experiment/stepped_daemon.h"

namespace regrasp::cli {

class GaitEvents {
 public:
  explicit GaitEvents(SteppedDaemon* daemon) : daemon_(*daemon) {}

  /// Takes the events of this run since the last call; the daemon keeps the last 1000.
  void Read();

  struct Counts {
    int slips = 0;        ///< regrasps broken off
    int refusals = 0;     ///< a finger might not leave for want of load margin
    int explored = 0;     ///< regrasps that explored by manipulability
    int low = 0;          ///< of these, begun below 98 % of the finger's best in this rotation
    int low_rose = 0;     ///< of those, noise-free manipulability higher at the end of exploring
    double gain_sum = 0;  ///< of all explored: relative rise from begin to end of exploring
  };
  Counts Count() const;
  /// When the gait failed: drops, and regrasps broken off, ascending [s].
  const std::vector<double>& failures_s() const { return failures_s_; }

 private:
  struct Exploration {
    double from, to;
  };
  SteppedDaemon& daemon_;
  std::int64_t last_tick_ = -1;
  std::vector<double> failures_s_;
  int slips_ = 0, refusals_ = 0;
  std::map<std::string, std::vector<Exploration>> explorations_;  // per finger
};

}  // namespace regrasp::cli
