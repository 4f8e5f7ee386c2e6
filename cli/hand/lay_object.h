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

/// Where a run may begin, by its seed: the preshape, and how far the object is from its place [m].
struct Start {
  JointVector q;
  Vector3d moved = Vector3d::Zero();
};

struct Way {
  Isometry3d X_WO = Isometry3d::Identity();
  int inside = 0;    ///< starts in which the object begins inside a link
  double depth = 0;  ///< largest, of every start [m]
};

/// Ways to lie with the box's axes along the hand's and its middle at `p_WB` or 5 mm beside it,
/// where that is clearer of links: those that begin no deeper in a link of the preshape than
/// `grasp` allows. First those that begin inside a link in the fewest of `starts`, then those that
/// are deepest in the fingers' way last.
std::vector<Way> WaysToLie(const LoadedScenario& model, const ObjectBox& box, const Vector3d& p_WB,
                           const std::vector<Start>& starts);

}  // namespace regrasp::hand
