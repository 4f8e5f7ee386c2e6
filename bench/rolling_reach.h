#pragma once

/// How far geometry lets a held ball turn while every fingertip that touches it rolls on it and
/// none slips or leaves: joint angles, limits and round surfaces only, without forces and without
/// the controller. What no finger can follow, no controller can do without sliding or a regrasp.

#include <vector>

#include "core/hand/finger_reach.h"

namespace regrasp {

struct Ball {
  Vector3d p_WO = Vector3d::Zero();  ///< centre [m]
  double radius = 0;                 ///< [m]
};

/// Way of a ball: it turns by `angle` about `axis_W` (unit, through its centre); in the first
/// 1 / kRollingSegments of the way its centre shifts and it turns aside, too.
struct BallWay {
  Vector3d axis_W = Vector3d::UnitZ();
  double angle = 0;                     ///< [rad]
  Vector3d shift_W = Vector3d::Zero();  ///< [m]
  Vector3d aside_W = Vector3d::Zero();  ///< rotation vector [rad]
};

struct RollingEnd {
  double angle = 0;  ///< to which the finger followed [rad]
  int joint = -1;    ///< of the hand, which would have to pass its limit; -1: followed to the end
};

/// The farthest that `finger`, which touches the ball at the angles `q` of the hand, can follow:
/// the best of all sequences in which its redundant motion (beyond the 3 coordinates of the
/// contact) goes one way, the other or rests, anew in each of `kRollingSegments` parts of the way.
/// The contact is the point of the tip's capsule that is nearest to the ball's centre.
RollingEnd FarthestRolling(const HandModel& hand, int finger, const JointVector& q,
                           const Ball& ball, const BallWay& way);
inline constexpr int kRollingSegments = 5;

/// How far the ball may be off the wanted turn.
struct Allowance {
  double shift = 0;  ///< of the centre [m]
  double aside = 0;  ///< about axes across the wanted one [rad]
};

struct RollingReach {
  double angle = 0;             ///< the farthest that all fingers can follow together [rad]
  int finger = -1, joint = -1;  ///< that ends it there; -1: nothing does
  Vector3d shift_W = Vector3d::Zero(), aside_W = Vector3d::Zero();  ///< the way on which it is
  /// For each of `fingers` the farthest if the others were not there, each on its own best way: the
  /// least of these bounds every way.
  std::vector<RollingEnd> alone;
};

/// The farthest turn up to `most` of all ways within the allowance: 26 directions of the shift and
/// none, each with 8 directions aside and none.
RollingReach FarthestTurn(const HandModel& hand, const std::vector<int>& fingers,
                          const JointVector& q, const Ball& ball, const Vector3d& axis_W,
                          double most, const Allowance& allowance);

}  // namespace regrasp
