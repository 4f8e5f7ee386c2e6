#include "core/hand/mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <map>
#include <system_error>
#include <utility>

namespace regrasp {
namespace {

constexpr std::size_t kMaxVertices = 200000;

void CheckClosed(const std::filesystem::path& file, const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : uses) {
    const auto opposite = uses.find({edge.second, edge.first});
    if (count == 1 && opposite != uses.end() && opposite->second == 1) continue;
    const Vector3d p = 0.5 * (mesh.vertices[edge.first] + mesh.vertices[edge.second]);
    throw ModelError(
        fmt::format("{}: mesh is not closed: the edge at ({:.4g}, {:.4g}, {:.4g}) must belong to "
                    "exactly two triangles "
                    "that face the same side",
                    file.string(), p.x(), p.y(), p.z()));
  }
}

}  // namespace

double Volume(const TriangleMesh& mesh) {
  double six_volumes = 0;
  for (const auto& t : mesh.triangles)
    six_volumes += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
  return six_volumes / 6;
}

TriangleMesh LoadClosedMesh(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw ModelError(fmt::format("{}: mesh file not found", file.string()));
  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                           aiProcess_DropNormals);
  if (scene == nullptr)
    throw ModelError(
        fmt::format("{}: cannot read the mesh: {}", file.string(), importer.GetErrorString()));

  TriangleMesh mesh;
  struct Less {
    bool operator()(const Vector3d& a, const Vector3d& b) const {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    }
  };
  std::map<Vector3d, int, Less> index;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    std::vector<int> of_part(part.mNumVertices);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const Vector3d p(part.mVertices[i].x, part.mVertices[i].y, part.mVertices[i].z);
      if (!p.allFinite())
        throw ModelError(fmt::format("{}: vertex {} is not finite", file.string(), i));
      const auto [it, is_new] = index.try_emplace(p, static_cast<int>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(p);
      of_part[i] = it->second;
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // stray points and lines enclose nothing
      mesh.triangles.emplace_back(of_part[face.mIndices[0]], of_part[face.mIndices[1]],
                                  of_part[face.mIndices[2]]);
    }
  }
  if (mesh.triangles.size() < 4 || mesh.vertices.size() > kMaxVertices)
    throw ModelError(
        fmt::format("{}: {} triangles on {} vertices; allowed are at least 4 on at most {}",
                    file.string(), mesh.triangles.size(), mesh.vertices.size(), kMaxVertices));
  CheckClosed(file, mesh);
  if (!(Volume(mesh) > 0))
    throw ModelError(fmt::format(
        "{}: the mesh's volume is {:.4g}; triangles must be counter-clockwise seen from outside",
        file.string(), Volume(mesh)));
  return mesh;
}

}  // namespace regrasp
