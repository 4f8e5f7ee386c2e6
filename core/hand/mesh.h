#pragma once

#include <filesystem>
#include <vector>

#include "core/common/frames.h"
#include "core/hand/model_error.h"

namespace regrasp {

struct TriangleMesh {
  std::vector<Vector3d> vertices;          ///< [m when the file is in metres]
  std::vector<Eigen::Vector3i> triangles;  ///< counter-clockwise seen from outside
};

/// Reads any format assimp knows, welding equal vertices, and checks that the surface is closed
/// (every edge belongs to two triangles that run through it in opposite senses) and faces outwards
/// (its volume is positive). Throws ModelError.
TriangleMesh LoadClosedMesh(const std::filesystem::path& file);

/// Volume enclosed by a closed mesh: sum over triangles of det(a, b, c) / 6.
double Volume(const TriangleMesh& mesh);

}  // namespace regrasp
