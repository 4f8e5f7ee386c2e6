#include "core/hand/object_pieces.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "core/hand/mesh_path.h"
#include "core/hand/primitive_mesh.h"
#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

/// Throws ModelError.
TriangleMesh MeshOf(const UrdfGeometry& geometry) {
  switch (geometry.kind) {
    case UrdfGeometry::Kind::kSphere:
      return CapsuleMesh(geometry.radius, 0);
    case UrdfGeometry::Kind::kCylinder:
      return CylinderMesh(geometry.radius, geometry.length / 2);
    case UrdfGeometry::Kind::kBox:
      return BoxMesh(geometry.size);
    case UrdfGeometry::Kind::kMesh:
      break;
  }
  std::error_code ignored;
  if (const std::string where = WherePackagesAre(geometry.mesh_name);
      !where.empty() && !std::filesystem::exists(geometry.mesh, ignored))
    throw ModelError(
        fmt::format("<mesh> filename = {}: file not found{}", Quoted(geometry.mesh_name), where));
  return LoadClosedMesh(geometry.mesh, geometry.scale);
}

}  // namespace

TriangleMesh JoinPieces(const std::vector<UrdfCollision>& pieces, const std::string& element,
                        Problems* problems) {
  TriangleMesh whole;
  const std::size_t before = problems->count();
  for (const UrdfCollision& piece : pieces) {
    TriangleMesh mesh;
    try {
      mesh = MeshOf(piece.geometry);
      if (mesh.unread_bytes > 0)
        problems->Warn(piece.geometry.line, element, UnreadBytes(piece.geometry.mesh, mesh));
    } catch (const ModelError& error) {
      problems->Add(piece.geometry.line, "{}: {}", element, error.what());
      continue;
    }
    const int base = static_cast<int>(whole.vertices.size());
    for (const Vector3d& v : mesh.vertices) whole.vertices.push_back(piece.X_LG * v);
    for (const auto& t : mesh.triangles)
      whole.triangles.push_back(t + Eigen::Vector3i::Constant(base));
  }
  constexpr std::size_t kMaxVertices = 200000;
  if (problems->count() == before && whole.vertices.size() > kMaxVertices)
    problems->Add(0, "the pieces have {} vertices; allowed are at most {}", whole.vertices.size(),
                  kMaxVertices);
  return whole;
}

}  // namespace regrasp
