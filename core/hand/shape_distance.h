#pragma once

/// How near a shape of a link is to a point, or to a ball.

#include "core/hand/hand_model.h"

namespace regrasp {

/// The point of a capsule's axis, or of a box, that is nearest to a point.
struct Nearest {
  Vector3d on_W;
  double radius = 0;  ///< of what is about it: a capsule's [m]
};
Nearest NearestOf(const Shape& shape, const Isometry3d& X_WL, const Vector3d& p_W);

/// Between a ball and what a finger's last link, at X_WL, has beside its fingertip; negative where
/// they overlap, at most `most` [m].
double GapBesideTip(const Link& last, const Isometry3d& X_WL, const Vector3d& centre_W,
                    double radius, double most);

}  // namespace regrasp
