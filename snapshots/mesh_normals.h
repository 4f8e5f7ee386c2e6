#pragma once

/// Normals by which a mesh is shaded.

#include <array>
#include <vector>

#include "core/common/frames.h"

namespace regrasp {

/// For each corner of each triangle the mean normal of the faces about it that lean by less than
/// 35° from the triangle's own, weighted by their areas: what is nearly flat is rounded off, a
/// sharp edge stays sharp. Unit vectors; those of a triangle without area are zero.
std::vector<std::array<Vector3d, 3>> CornerNormals(const std::vector<Vector3d>& vertices,
                                                   const std::vector<Eigen::Vector3i>& triangles);

}  // namespace regrasp
