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

}  // namespace regrasp
