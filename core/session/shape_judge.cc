#include "core/session/shape_judge.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace regrasp {

ShapeErrors JudgeShape(const FeltSurface& felt, const TrueSurface& truth) {
  ShapeErrors errors;
  errors.touched = felt.touched_share();
  std::array<double, FeltSurface::kCells> angles;
  for (int i = 0; i < FeltSurface::kCells; ++i) {
    const FeltSurface::Cell& cell = felt.cell(i);
    if (cell.count < felt.parameters().full) continue;
    const SurfacePoint point = felt.At(cell.direction_sum);
    const TrueSurface::Nearest nearest = truth.At(point.p_O);
    errors.rms_m += nearest.distance * nearest.distance;
    errors.mean_m += nearest.distance;
    angles[errors.cells++] = std::acos(std::clamp(point.normal_O.dot(nearest.normal_O), -1.0, 1.0));
  }
  if (errors.cells == 0) return errors;
  errors.rms_m = std::sqrt(errors.rms_m / errors.cells);
  errors.mean_m /= errors.cells;
  std::nth_element(angles.begin(), angles.begin() + errors.cells / 2,
                   angles.begin() + errors.cells);
  errors.normal_rad = angles[errors.cells / 2];
  return errors;
}

}  // namespace regrasp
