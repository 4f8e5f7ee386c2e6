#include "core/hand/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "core/hand/flat_triangles.h"

namespace regrasp {
namespace {

constexpr std::size_t kMaxVertices = 200000;  // of a welded mesh

/// Corners by cell of a grid; a corner is looked for in its own cell and the 26 around it.
class Welder {
 public:
  Welder(const Vector3d& corner, double distance) : corner_(corner), distance_(distance) {}

  int Add(const Vector3d& p, std::vector<Vector3d>* vertices) {
    const Cell cell = CellOf(p);
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const auto found = first_.find(Key({cell[0] + dx, cell[1] + dy, cell[2] + dz}));
          if (found == first_.end()) continue;
          for (int i = found->second; i >= 0; i = next_[static_cast<std::size_t>(i)])
            if (((*vertices)[static_cast<std::size_t>(i)] - p).norm() < distance_) return i;
        }
    const int index = static_cast<int>(vertices->size());
    vertices->push_back(p);
    const auto [it, is_new] = first_.try_emplace(Key(cell), -1);
    next_.push_back(it->second);
    it->second = index;
    return index;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell CellOf(const Vector3d& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k)
      cell[static_cast<std::size_t>(k)] =
          static_cast<std::int64_t>(std::floor((p[k] - corner_[k]) / distance_));
    return cell;
  }
  // Cells that share a key share a list: slower, never wrong.
  static std::uint64_t Key(const Cell& c) {
    return static_cast<std::uint64_t>(c[0]) * 0x9E3779B97F4A7C15ULL ^
           static_cast<std::uint64_t>(c[1]) * 0xC2B2AE3D27D4EB4FULL ^
           static_cast<std::uint64_t>(c[2]) * 0x165667B19E3779F9ULL;
  }

  Vector3d corner_;  // of the bounding box, so that cells have small numbers
  double distance_;
  std::unordered_map<std::uint64_t, int> first_;
  std::vector<int> next_;
};

/// How often triangles run through an edge from its corner of the lower index, and back.
struct EdgeUse {
  int forth = 0, back = 0;
};
using Edges = std::map<std::pair<int, int>, EdgeUse>;

Edges EdgesOf(const TriangleMesh& mesh, bool with_flat) {
  Edges edges;
  for (const auto& t : mesh.triangles) {
    if (!with_flat && IsFlat(mesh, t)) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      EdgeUse& use = edges[std::minmax(a, b)];
      ++(a < b ? use.forth : use.back);
    }
  }
  return edges;
}

bool IsClosed(const Edges& edges) {
  return std::ranges::all_of(
      edges, [](const auto& edge) { return edge.second.forth == edge.second.back; });
}

/// What is wrong with a surface that is not closed, by what is wrong with its edges.
struct OpenSurface {
  bool (*is_wrong)(const EdgeUse&);
  const char *is, *what, *cure;
};
constexpr OpenSurface kOpenSurfaces[] = {
    {[](const EdgeUse& use) { return use.forth + use.back == 1; }, "is not closed:", "are open",
     "each must belong to two triangles that face the same side: merge corners and close holes "
     "(Blender: Mesh > Clean Up > Merge by Distance, Fill Holes)"},
    {[](const EdgeUse& use) { return (use.forth + use.back) % 2 != 0; },
     "is not one surface:", "belong to three triangles or more",
     "each must belong to two: remove what lies inside (Blender: Select > All by Trait > Interior "
     "Faces)"},
    {[](const EdgeUse& use) { return use.forth != use.back; }, "has no holes, but along",
     "triangles are turned against their neighbours",
     "all must be counter-clockwise seen from outside (Blender: Mesh > Normals > Recalculate "
     "Outside)"}};

/// Throws ModelError with what an open surface has: holes, triangles within, or turned ones.
[[noreturn]] void RefuseOpen(const std::filesystem::path& file, const TriangleMesh& mesh,
                             const Edges& edges) {
  const OpenSurface* found = kOpenSurfaces;
  const auto wrong = [&](const auto& edge) { return found->is_wrong(edge.second); };
  while (std::ranges::none_of(edges, wrong)) ++found;  // the last has some: it is not closed
  const auto count = std::ranges::count_if(edges, wrong);
  const auto& [a, b] = std::ranges::find_if(edges, wrong)->first;
  const Vector3d p = 0.5 * (mesh.vertices[a] + mesh.vertices[b]);
  throw ModelError(fmt::format(
      "{}: mesh {} {} of {} edges {}, the first at ({:.4g}, {:.4g}, {:.4g}); {}", file.string(),
      found->is, count, edges.size(), found->what, p.x(), p.y(), p.z(), found->cure));
}

/// Makes the surface closed by triangles that have an area. Throws ModelError where it is not
/// closed.
void DropFlat(const std::filesystem::path& file, TriangleMesh* mesh) {
  if (!IsClosed(EdgesOf(*mesh, false))) {
    if (const Edges edges = EdgesOf(*mesh, true); !IsClosed(edges)) RefuseOpen(file, *mesh, edges);
    FlipFlat(mesh);
  }
  std::erase_if(mesh->triangles, [&](const auto& t) { return IsFlat(*mesh, t); });
}

double VolumeOf(const std::vector<Vector3d>& vertices,
                const std::vector<Eigen::Vector3i>& triangles) {
  double six_volumes = 0;
  for (const auto& t : triangles)
    six_volumes += vertices[t[0]].dot(vertices[t[1]].cross(vertices[t[2]]));
  return six_volumes / 6;
}

/// A piece that faces inwards is a cavity, and lies in another piece.
void CheckCavities(const std::filesystem::path& file, const TriangleMesh& mesh) {
  constexpr int kMost = 32;  // that are looked at: each costs as much as the mesh has triangles
  const auto pieces = PiecesOf(mesh);
  int inwards = 0;
  for (std::size_t i = 0; pieces.size() > 1 && i < pieces.size() && inwards < kMost; ++i) {
    const double volume = VolumeOf(mesh.vertices, pieces[i]);
    if (volume >= 0) continue;
    ++inwards;
    const Vector3d p = mesh.vertices[pieces[i][0][0]];
    std::vector<Eigen::Vector3i> others;
    for (std::size_t k = 0; k < pieces.size(); ++k)
      if (k != i) others.insert(others.end(), pieces[k].begin(), pieces[k].end());
    if (!IsInside(mesh.vertices, others, p))
      throw ModelError(fmt::format(
          "{}: the piece at ({:.4g}, {:.4g}, {:.4g}) is inside out and no cavity of another: its "
          "volume is {:.4g}; triangles must be counter-clockwise seen from outside",
          file.string(), p.x(), p.y(), p.z(), volume));
  }
}

void DropUnused(TriangleMesh* mesh) {
  std::vector<int> place(mesh->vertices.size(), -1);
  std::vector<Vector3d> used;
  for (auto& t : mesh->triangles)
    for (int& corner : t) {
      int& at = place[static_cast<std::size_t>(corner)];
      if (at < 0) {
        at = static_cast<int>(used.size());
        used.push_back(mesh->vertices[static_cast<std::size_t>(corner)]);
      }
      corner = at;
    }
  mesh->vertices = std::move(used);
}

}  // namespace

std::string UnreadBytes(const std::filesystem::path& file, const TriangleMesh& mesh) {
  return fmt::format("{}: {} bytes beside its triangles are not read", file.string(),
                     mesh.unread_bytes);
}

double Volume(const TriangleMesh& mesh) { return VolumeOf(mesh.vertices, mesh.triangles); }

std::vector<std::vector<Eigen::Vector3i>> PiecesOf(const TriangleMesh& mesh) {
  std::vector<int> up(mesh.vertices.size());
  std::iota(up.begin(), up.end(), 0);
  const auto top = [&](int i) {
    while (up[static_cast<std::size_t>(i)] != i)
      i = up[static_cast<std::size_t>(i)] =
          up[static_cast<std::size_t>(up[static_cast<std::size_t>(i)])];
    return i;
  };
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int k = 1; k < 3; ++k) up[static_cast<std::size_t>(top(t[k]))] = top(t[0]);
  std::map<int, std::vector<Eigen::Vector3i>> pieces;
  for (const Eigen::Vector3i& t : mesh.triangles) pieces[top(t[0])].push_back(t);
  std::vector<std::vector<Eigen::Vector3i>> list;
  for (auto& [first, triangles] : pieces) list.push_back(std::move(triangles));
  return list;
}

bool IsInside(const std::vector<Vector3d>& vertices, const std::vector<Eigen::Vector3i>& triangles,
              const Vector3d& p) {
  double angle = 0;
  for (const Eigen::Vector3i& t : triangles) {
    const Vector3d a = vertices[t[0]] - p, b = vertices[t[1]] - p, c = vertices[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2 * M_PI;
}

TriangleMesh WeldMesh(const RawMesh& raw, const Vector3d& scale) {
  TriangleMesh mesh;
  mesh.unread_bytes = raw.unread_bytes;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& v : raw.vertices)
    box.extend(Vector3d(v.cast<double>().cwiseProduct(scale)));
  const double size = box.isEmpty() ? 0 : box.sizes().norm();
  Welder welder(box.isEmpty() ? Vector3d::Zero() : Vector3d(box.min()),
                std::max(kWeld, 1e-6 * size));
  std::vector<int> of_raw;
  for (const Eigen::Vector3f& v : raw.vertices)
    of_raw.push_back(welder.Add(v.cast<double>().cwiseProduct(scale), &mesh.vertices));
  const bool mirrored = scale.prod() < 0;
  std::set<std::array<int, 3>> seen;
  for (const Eigen::Vector3i& t : raw.triangles) {
    Eigen::Vector3i w(of_raw[t[0]], of_raw[t[1]], of_raw[t[2]]);
    if (mirrored) std::swap(w[1], w[2]);
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) continue;
    std::array<int, 3> key = {w[0], w[1], w[2]};
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    if (seen.insert(key).second) mesh.triangles.push_back(w);
  }
  DropUnused(&mesh);
  return mesh;
}

TriangleMesh LoadMesh(const std::filesystem::path& file, const Vector3d& scale) {
  TriangleMesh mesh = WeldMesh(ReadMeshFile(file), scale);
  if (mesh.triangles.empty())
    throw ModelError(fmt::format("{}: the mesh has no triangle", file.string()));
  return mesh;
}

void CloseMesh(const std::filesystem::path& file, bool mirrored, TriangleMesh* mesh) {
  if (mesh->triangles.size() < 4 || mesh->vertices.size() > kMaxVertices)
    throw ModelError(
        fmt::format("{}: {} triangles on {} vertices; allowed are at least 4 on at most {}",
                    file.string(), mesh->triangles.size(), mesh->vertices.size(), kMaxVertices));
  DropFlat(file, mesh);
  DropUnused(mesh);
  double volume = Volume(*mesh);
  if (mirrored && volume < 0) {
    for (auto& t : mesh->triangles) std::swap(t[1], t[2]);
    volume = -volume;
  }
  if (!(volume > 0) || mesh->triangles.size() < 4)
    throw ModelError(fmt::format(
        "{}: the mesh's volume is {:.4g}; triangles must be counter-clockwise seen from outside",
        file.string(), volume));
  CheckCavities(file, *mesh);
}

TriangleMesh LoadClosedMesh(const std::filesystem::path& file, const Vector3d& scale) {
  TriangleMesh mesh = WeldMesh(ReadMeshFile(file), scale);
  CloseMesh(file, scale.prod() < 0, &mesh);
  return mesh;
}

}  // namespace regrasp
