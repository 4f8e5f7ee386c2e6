#pragma once

/// The <collision> elements of an object as one mesh. Used only by the object's loader.

#include <string>
#include <vector>

#include "core/hand/mesh.h"
#include "core/hand/urdf_file.h"

namespace regrasp {

/// Every piece where it stands in the link, each a closed surface (round ones by facets,
/// primitive_mesh.h). Meshes that cannot be read, and more vertices than an object may have, are
/// problems of `element`.
TriangleMesh JoinPieces(const std::vector<UrdfCollision>& pieces, const std::string& element,
                        Problems* problems);

/// Pieces that hang together: those whose boxes are no more than 1 mm apart. `gap`: least distance
/// of boxes of two parts [m].
struct Parts {
  int count = 1;
  double gap = 0;
};
/// One part where there are more than a thousand pieces.
Parts PartsOf(const std::vector<Vector3d>& vertices,
              const std::vector<std::vector<Eigen::Vector3i>>& pieces);

}  // namespace regrasp
