#pragma once

/// The search for a posture in which a hand grasps a ball with every fingertip.

#include <cstdint>
#include <functional>
#include <vector>

#include "core/posture/ball_grasp.h"

namespace regrasp {

struct GraspSearch {
  BallTask task;
  std::uint64_t seed = 1;
  int steps = 4000;  ///< of hill climbing, per start
  int starts = 6;    ///< that are climbed
  double reach = 1;  ///< size of the first steps, in shares of (4 mm, 0.2 rad)
  /// Told now and then: share of the work done, best score so far.
  std::function<void(double done, double score)> progress = [](double, double) {};
};

/// Climbs from `start`, whose tips need not touch. Random hill climbing over the ball's place and
/// the joint angles, steps shrinking to a thirtieth; every candidate is projected onto contact.
/// score -1e9 where nothing touches.
BallGrasp ClimbGrasp(const HandModel& hand, const GraspSearch& search, const BallGrasp& start);

/// Grasps found from random starts, the best first, at most `search.starts`; empty where the tips
/// never touch one ball together. Deterministic.
std::vector<BallGrasp> FindGrasps(const HandModel& hand, const GraspSearch& search);

}  // namespace regrasp
