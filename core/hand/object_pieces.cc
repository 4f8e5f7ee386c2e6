#include "core/hand/object_pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
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
    throw ModelError(fmt::format("<mesh> filename = {}: file not found{}",
                                 QuotedPath(geometry.mesh_name), where));
  return LoadClosedMesh(geometry.mesh, geometry.scale);
}

/// Gives the number `of` to box `first` and to all that hang together with it.
void Spread(const std::vector<Eigen::AlignedBox3d>& boxes, std::size_t first, int of,
            std::vector<int>* part) {
  constexpr double kTouch = 1e-3;  // [m]
  std::vector<std::size_t> open = {first};
  (*part)[first] = of;
  while (!open.empty()) {
    const std::size_t i = open.back();
    open.pop_back();
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      if ((*part)[k] >= 0 || boxes[i].exteriorDistance(boxes[k]) > kTouch) continue;
      (*part)[k] = of;
      open.push_back(k);
    }
  }
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

Parts PartsOf(const std::vector<Vector3d>& vertices,
              const std::vector<std::vector<Eigen::Vector3i>>& pieces) {
  constexpr std::size_t kMost = 1000;  // each is held against each
  if (pieces.size() > kMost) return {};
  std::vector<Eigen::AlignedBox3d> boxes(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const Eigen::Vector3i& t : pieces[i])
      for (const int corner : t) boxes[i].extend(vertices[static_cast<std::size_t>(corner)]);
  Parts parts;
  parts.count = 0;
  std::vector<int> part(pieces.size(), -1);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (part[i] < 0) Spread(boxes, i, parts.count++, &part);
  if (parts.count < 2) return parts;
  parts.gap = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t k = 0; k < pieces.size(); ++k)
      if (part[i] < part[k]) parts.gap = std::min(parts.gap, boxes[i].exteriorDistance(boxes[k]));
  return parts;
}

}  // namespace regrasp
