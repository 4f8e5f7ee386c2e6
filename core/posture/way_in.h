#pragma once

/// How the fingers get to a grasp: an open posture and one beyond the surface, with the contacts on
/// the straight way from one to the other.

#include "core/common/random.h"
#include "core/posture/ball_grasp.h"

namespace regrasp {

struct WayIn {
  JointVector open, closed;  ///< driven joints [rad]
  double gap = 0;            ///< least gap of links on the way [m]
  int stuck = -1;            ///< a finger that finds no way; -1 where all do
};

/// Each finger from task.gap off the ball to 7.5 mm inside it (2.5 mm where it cannot), so that
/// smaller and larger balls are touched about where `grasp` touches this one. Random search for
/// joints off their limits, links clear of each other and short, straight ways. `attempts`: ways
/// that are compared.
WayIn FindWayIn(const HandModel& hand, const BallTask& task, const BallGrasp& grasp, int attempts,
                RandomStream* random);

}  // namespace regrasp
