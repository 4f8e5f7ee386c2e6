#include "snapshots/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "core/common/box_corners.h"

namespace regrasp {
namespace {

constexpr double kSharp =
    0.8;  // cosine between two faces below which their common edge is sharp (37°)

/// Rings about z from the lower to the upper pole.
ObjectMesh RoundMesh(double radius) {
  constexpr int kAround = 72, kUp = 36;
  ObjectMesh mesh;
  for (int i = 0; i <= kUp; ++i) {
    const double latitude = std::numbers::pi * (static_cast<double>(i) / kUp - 0.5);
    for (int j = 0; j < kAround; ++j) {
      const double a = 2 * std::numbers::pi * j / kAround;
      mesh.vertices_O.emplace_back(radius * std::cos(latitude) * std::cos(a),
                                   radius * std::cos(latitude) * std::sin(a),
                                   radius * std::sin(latitude));
    }
  }
  for (int i = 0; i < kUp; ++i)
    for (int j = 0; j < kAround; ++j) {
      const int a = i * kAround + j, b = i * kAround + (j + 1) % kAround;
      if (i > 0) mesh.triangles.emplace_back(a, b, b + kAround);
      if (i < kUp - 1) mesh.triangles.emplace_back(a, b + kAround, a + kAround);
    }
  return mesh;
}

ObjectMesh BoxMesh(const Vector3d& h) {
  ObjectMesh mesh;
  std::ranges::copy(BoxCorners(h), std::back_inserter(mesh.vertices_O));
  for (const auto& f : std::array<std::array<int, 4>, 6>{
           {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}}) {
    mesh.triangles.emplace_back(f[0], f[1], f[2]);
    mesh.triangles.emplace_back(f[0], f[2], f[3]);
  }
  return mesh;
}

Vector3d NormalOf(const ObjectMesh& mesh, const Eigen::Vector3i& t) {
  const Vector3d& a = mesh.vertices_O[t[0]];
  return (mesh.vertices_O[t[1]] - a).cross(mesh.vertices_O[t[2]] - a).normalized();
}

/// Every edge that two triangles share, with their normals. Vertices at one place count as one.
std::vector<SurfaceLine> Edges(const ObjectMesh& mesh) {
  std::map<std::array<double, 3>, int> first_at;
  std::vector<int> same(mesh.vertices_O.size());
  for (std::size_t i = 0; i < same.size(); ++i) {
    const Vector3d& v = mesh.vertices_O[i];
    same[i] = first_at.try_emplace({v.x(), v.y(), v.z()}, static_cast<int>(i)).first->second;
  }
  std::map<std::pair<int, int>, Vector3d> open;
  std::vector<SurfaceLine> edges;
  for (const auto& t : mesh.triangles) {
    const Vector3d normal = NormalOf(mesh, t);
    for (int k = 0; k < 3; ++k) {
      const int a = same[t[k]], b = same[t[(k + 1) % 3]];
      if (const auto other = open.find({b, a}); other != open.end()) {
        edges.push_back({mesh.vertices_O[a], mesh.vertices_O[b], normal, other->second});
        open.erase(other);
      } else {
        open[{a, b}] = normal;
      }
    }
  }
  return edges;
}

void Cut(const ObjectMesh& mesh, const Vector3d& n, double offset,
         std::vector<SurfaceLine>* lines) {
  for (const auto& t : mesh.triangles) {
    std::array<Vector3d, 2> ends;
    int found = 0;
    for (int k = 0; k < 3 && found < 2; ++k) {
      const Vector3d &a = mesh.vertices_O[t[k]], &b = mesh.vertices_O[t[(k + 1) % 3]];
      const double da = n.dot(a) - offset, db = n.dot(b) - offset;
      if ((da < 0) != (db < 0)) ends[found++] = a + (b - a) * (da / (da - db));
    }
    if (found < 2) continue;
    const Vector3d normal = NormalOf(mesh, t);
    lines->push_back({ends[0], ends[1], normal, normal});
  }
}

}  // namespace

ObjectMesh MeshOf(const ObjectModel& object) {
  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
      return RoundMesh(object.radius);
    case ObjectModel::Kind::kBox:
      return BoxMesh(object.half_extents);
    case ObjectModel::Kind::kMesh:
      break;
  }
  return {object.vertices_O, object.triangles};
}

std::vector<SurfaceLine> ShapeLines(const ObjectMesh& mesh) {
  std::vector<SurfaceLine> lines;
  for (const SurfaceLine& edge : Edges(mesh))
    if (edge.n1_O.dot(edge.n2_O) < kSharp) lines.push_back(edge);
  double low = 0, high = 0;
  for (const Vector3d& v : mesh.vertices_O) {
    low = std::min(low, v.z());
    high = std::max(high, v.z());
  }
  // The middle of the range plus sines of -60, -30, 0, 30 and 60 degrees: parallels of a globe. The
  // tiny offsets keep the planes off the vertices.
  for (double s : {-0.8660, -0.5001, 1e-7, 0.5001, 0.8660})
    Cut(mesh, Vector3d::UnitZ(), 0.5 * (low + high) + s * 0.5 * (high - low), &lines);
  for (int i = 0; i < 4; ++i) {
    const double a = i * std::numbers::pi / 4 + 1e-6;
    Cut(mesh, {std::cos(a), std::sin(a), 0}, 1e-9, &lines);
  }
  return lines;
}

std::vector<SurfaceLine> Silhouette(const ObjectMesh& mesh, const Vector3d& to_viewer_O) {
  std::vector<SurfaceLine> lines = Edges(mesh);
  std::erase_if(lines, [&](const SurfaceLine& edge) {
    return (edge.n1_O.dot(to_viewer_O) > 0) == (edge.n2_O.dot(to_viewer_O) > 0);
  });
  return lines;
}

}  // namespace regrasp
