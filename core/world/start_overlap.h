#pragma once

/// Whether the object begins inside the hand: then no grasp of it means anything. Pure geometry, no
/// ODE; for the moment a world is built, not for a tick.

#include <vector>

#include "core/common/frames.h"
#include "core/hand/hand_model.h"
#include "core/hand/object_model.h"

namespace regrasp {

struct StartOverlap {
  int link = -1;     ///< -1: nothing overlaps
  double depth = 0;  ///< [m]
};

/// Deeper than this the object begins inside a link [m]: half of what a contact spring of 4000 N/m
/// turns into the force of a firm grip.
inline constexpr double kStartOverlap = 2e-3;

/// The link that reaches farthest into the object, both at the given poses. Points along the
/// segment of a capsule and over the surface of a box are looked at, so a depth may come out too
/// small by the part of a capsule or box that lies between two of them.
StartOverlap DeepestOverlap(const HandModel& hand, const std::vector<Isometry3d>& X_WL,
                            const ObjectModel& object, const Isometry3d& X_WO);

}  // namespace regrasp
