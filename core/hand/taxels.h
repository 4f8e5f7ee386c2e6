#pragma once

/// A tactile fingertip: 12 taxels in four rows of three on the rounded end and the pad of the last
/// link.

#include <array>

#include "core/common/frames.h"
#include "core/hand/hand_model.h"

namespace regrasp {

/// How taxels lie on a fingertip. The tip's shape is a capsule (or sphere) with its far end at
/// `p_LF`.
struct TipAxes {
  Vector3d p_LF = Vector3d::Zero();      ///< centre of the rounding sphere [m]
  Vector3d along_L = Vector3d::UnitZ();  ///< unit, out of the fingertip along the capsule
  Vector3d pad_L =
      Vector3d::UnitY();  ///< unit, the side that flexion of the last joint moves towards
  Vector3d side_L = Vector3d::UnitX();  ///< along x pad
  double radius = 0;                    ///< [m]
  double segment = 0;                   ///< length of the capsule's segment [m]
};

TipAxes MakeTipAxes(const HandModel& hand, int finger);

struct Taxel {
  Vector3d p_LT = Vector3d::Zero();        ///< centre, on the surface [m]
  Vector3d outward_L = Vector3d::UnitZ();  ///< unit
};

inline constexpr int kTaxelRows = 4, kTaxelColumns = 3;

using Taxels = std::array<Taxel, kTaxelRows * kTaxelColumns>;

/// The taxels `pitch` [m] apart: rows at 1/2, 3/2, 5/2, 7/2 pitches along the surface from the
/// apex, over the rounded end and then back along the pad; columns one pitch apart around the link,
/// centred on the pad, at most 120 degrees. Rows that would lie behind the segment's start lie at
/// its start.
Taxels MakeTaxels(const TipAxes& tip, double pitch);

/// The taxel whose centre is nearest to `p_L` [m, frame of the tip link]; the first of equals.
const Taxel& NearestTaxel(const Taxels& taxels, const Vector3d& p_L);

}  // namespace regrasp
