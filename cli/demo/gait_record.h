#pragma once

/// What a rotation looked like from outside, sampled while it ran: contacts and quality by the
/// state of the gait.

#include <Eigen/Core>
#include <map>
#include <vector>

#include "cli/experiment/stepped_daemon.h"

namespace regrasp::cli {

class GaitRecord {
 public:
  /// Takes one sample. Call it every 50 ms or so.
  void Look(SteppedDaemon* daemon);

  /// {"objective": {FINGER: {CRITERION: samples}}, where `switched` is what it is while the grasp
  /// is stable enough: manipulability; "stability_mean": of the grasp,
  /// "stability_without_next_mean": what S_F maximises, while it does, null without such samples;
  /// "contact_points": n, "sphere": {"radius_m", "rms_error_m"} or null}
  Json ToJson() const;

 private:
  std::map<std::string, std::map<std::string, int>> objective_;
  double stability_sum_ = 0, without_next_sum_ = 0;
  int stability_samples_ = 0, without_next_samples_ = 0;
  std::vector<Eigen::Vector3d> p_OC_;  // contact points as sensed, in the object's frame [m]
};

}  // namespace regrasp::cli
