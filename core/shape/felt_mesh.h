#pragma once

/// The felt surface as triangles, for pictures and files.

#include <Eigen/Core>
#include <vector>

#include "core/shape/felt_surface.h"

namespace regrasp {

struct FeltMesh {
  std::vector<SurfacePoint> vertices;
  std::vector<Eigen::Vector3i> triangles;  ///< counter-clockwise seen from outside
};

/// Closed: an icosahedron whose triangles are split in four `divisions` times (0 to 6), each vertex
/// moved to the felt surface in its direction: 10 · 4^divisions + 2 vertices, some microseconds
/// each. Where nothing was felt it is the surface's guess; SurfacePoint::unknown tells.
FeltMesh MeshOf(const FeltSurface& felt, int divisions);

}  // namespace regrasp
