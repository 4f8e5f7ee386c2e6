#pragma once

/// The motion reserve that the gait counts on: whole steps only. What is left of the last one is
/// not promised, so that a finger nearly at its limit holds the turn up instead of being driven
/// into it.

#include <cmath>

#include "core/hand/finger_reach.h"

namespace regrasp {

/// MotionReserve() rounded down to its steps (kTurnStep), at most `most` [rad].
inline double SureReserve(const HandModel& hand, int finger, const FingerPosture& from,
                          const Vector3d& p_WO, const Vector3d& axis_W, double margin, double most,
                          const ReachRule& rule) {
  const double reserve = MotionReserve(hand, finger, from, p_WO, axis_W, margin, most, rule);
  return reserve >= most ? most : kTurnStep * std::floor(reserve / kTurnStep);
}

}  // namespace regrasp
