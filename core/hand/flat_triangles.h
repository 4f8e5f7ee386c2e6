#pragma once

/// Triangles without area. Whoever cuts surfaces into triangles puts one where a corner lies on the
/// edge of another triangle, so that every edge still belongs to two.

#include "core/hand/mesh.h"

namespace regrasp {

/// No area: the height over the longest side is less than a thousandth of kWeld.
bool IsFlat(const TriangleMesh& mesh, const Eigen::Vector3i& triangle);

/// Mends a surface that only flat triangles close: the long edge of each is flipped, so that the
/// triangle across it is cut in two at the corner that lies on it and the surface is closed without
/// them. The shape stays. Where a surface is too tangled for that flat triangles are left.
void FlipFlat(TriangleMesh* mesh);

}  // namespace regrasp
