#include "core/quality/grasp.h"

namespace regrasp {

TangentBasis ContactTangents(const Vector3d& inward_normal) {
  constexpr double kParallel = 1e-6;  // sine of the angle to e_x below which it counts as parallel
  Vector3d t1 = inward_normal.cross(Vector3d::UnitX());
  if (t1.squaredNorm() < kParallel * kParallel) t1 = inward_normal.cross(Vector3d::UnitZ());
  t1.normalize();
  return {t1, inward_normal.cross(t1)};
}

}  // namespace regrasp
