#pragma once

#include <array>

#include "core/common/frames.h"

namespace regrasp {

/// The corners of a box about the origin with these half edges: x changes fastest, then y, from
/// minus to plus.
inline std::array<Vector3d, 8> BoxCorners(const Vector3d& half) {
  std::array<Vector3d, 8> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners[i] = half.cwiseProduct(Vector3d(i & 1u ? 1 : -1, i & 2u ? 1 : -1, i & 4u ? 1 : -1));
  return corners;
}

}  // namespace regrasp
