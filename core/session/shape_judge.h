#pragma once

#include "core/shape/felt_surface.h"
#include "core/world/true_surface.h"

namespace regrasp {

/// What was felt against the truth, over the directions that have been felt well; for judging only.
struct ShapeErrors {
  int cells = 0;          ///< compared
  double touched = 0;     ///< share of all directions felt, 0 to 1
  double rms_m = 0;       ///< distance of the felt surface from the true one [m]
  double mean_m = 0;      ///< its bias, positive outside [m]
  double normal_rad = 0;  ///< median angle between the normals [rad]
};
ShapeErrors JudgeShape(const FeltSurface& felt, const TrueSurface& truth);

}  // namespace regrasp
