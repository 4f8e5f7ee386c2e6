#pragma once

/// How an object that is no ball may lie in a grasp that was found for a ball.

#include <array>
#include <vector>

#include "core/hand/scenario.h"

namespace regrasp::hand {

/// The object's principal axes, and its box along them. Where principal moments are equal within
/// 1 %, as a cube's or a square prism's, the axes of its file are kept, as far as they are free.
struct ObjectBox {
  Matrix3d R_OB = Matrix3d::Identity();  ///< axes of the box in O
  Vector3d size = Vector3d::Zero();      ///< along them [m]
  Vector3d p_OB = Vector3d::Zero();      ///< its middle in O [m]
  double reach = 0;                      ///< of the farthest corner from there [m]
  std::vector<Matrix3d> turns;           ///< R_WB that bring its axes onto those of the hand: 24,
                                         ///< or fewer where some make no difference;
                                         ///< first each along which the longest may lie
};
ObjectBox BoxOf(const ObjectModel& object);

/// Diameters of balls that stand for the object in the search [m], each at least `least`: the mean
/// of its two smaller extents, somewhat more, each of the two; those that differ.
std::vector<double> BallsFor(const ObjectBox& box, double least);

/// Poses X_WO with the box's middle at `p_WB` and its axes along the hand's, that begin no deeper
/// in a link of the preshape than `grasp` allows; those that are deepest in the fingers' way last.
std::vector<Isometry3d> WaysToLie(const LoadedScenario& model, const ObjectBox& box,
                                  const Vector3d& p_WB);

}  // namespace regrasp::hand
