#pragma once

/// How near the boxes of two fingers' outer links come to each other and to straight links. A
/// capsule inside a box (BonesOf) leaves its edges out, which reach 4 mm beyond it in a link of
/// 20 mm: fingers that meet there lean on each other instead of on the object.

#include "core/hand/finger_reach.h"

namespace regrasp {

struct PlacedBox {
  Isometry3d X_WB = Isometry3d::Identity();  ///< its centre frame
  Vector3d half_extents = Vector3d::Zero();  ///< [m]
};

/// The boxes among the shapes of the finger's last link and, unless that is the palm, of the link
/// before; those beyond eight are left out.
using Boxes = FixedVector<PlacedBox, 8>;
Boxes BoxesOf(const HandModel& hand, int finger, const FingerPosture& posture);

/// Between two boxes [m]: the widest gap across a plane along a face of one of them or along an
/// edge of each. Negative where they overlap; where corners face each other it is more than that.
double Gap(const PlacedBox& one, const PlacedBox& two);

/// Between a box and a straight link [m]; where its axis meets the box, minus its radius; 1 m where
/// the link has no shape (radius 0).
double Gap(const PlacedBox& box, const Bone& bone);

}  // namespace regrasp
