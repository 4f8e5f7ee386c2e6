#include "core/shape/felt_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace regrasp {
namespace {

struct Directions {
  std::vector<Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
};

/// Twelve vertices: a ring of five above and one below the equator, and the poles.
Directions Icosahedron() {
  Directions d;
  const double height = 1 / std::sqrt(5.0), radius = 2 / std::sqrt(5.0);
  d.vertices.push_back(Vector3d::UnitZ());
  for (int k = 0; k < 10; ++k) {
    const double angle = k * std::numbers::pi / 5;
    d.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                            k % 2 == 0 ? height : -height);
  }
  d.vertices.push_back(-Vector3d::UnitZ());
  for (int k = 0; k < 10; k += 2) {
    const int up = 1 + k, low = 2 + k, next_up = 1 + (k + 2) % 10, next_low = 1 + (k + 3) % 10;
    d.triangles.emplace_back(0, up, next_up);
    d.triangles.emplace_back(up, low, next_up);
    d.triangles.emplace_back(low, next_low, next_up);
    d.triangles.emplace_back(low, 11, next_low);
  }
  return d;
}

Directions Split(Directions d) {
  std::map<std::pair<int, int>, int> middles;  // of edges
  const auto middle = [&](int a, int b) {
    const auto [at, added] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(d.vertices.size()));
    if (added) d.vertices.push_back((d.vertices[a] + d.vertices[b]).normalized());
    return at->second;
  };
  std::vector<Eigen::Vector3i> split;
  for (const Eigen::Vector3i& t : d.triangles) {
    const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    split.emplace_back(t[0], ab, ca);
    split.emplace_back(ab, t[1], bc);
    split.emplace_back(ca, bc, t[2]);
    split.emplace_back(ab, bc, ca);
  }
  d.triangles = std::move(split);
  return d;
}

}  // namespace

FeltMesh MeshOf(const FeltSurface& felt, int divisions) {
  assert(divisions >= 0 && divisions <= 6);
  Directions d = Icosahedron();
  for (int i = 0; i < divisions; ++i) d = Split(std::move(d));
  FeltMesh mesh;
  mesh.vertices.reserve(d.vertices.size());
  for (const Vector3d& direction : d.vertices) mesh.vertices.push_back(felt.At(direction));
  mesh.triangles = std::move(d.triangles);
  return mesh;
}

}  // namespace regrasp
