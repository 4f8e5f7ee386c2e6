#include "core/hand/flat_triangles.h"

#include <algorithm>
#include <map>
#include <utility>

namespace regrasp {
namespace {

/// Corners a, b, c of a triangle, the edge from a to b being its longest.
struct Turned {
  int a, b, c;
};

Turned LongEdgeFirst(const TriangleMesh& mesh, const Eigen::Vector3i& t) {
  const auto length = [&](int k) {
    return (mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]]).norm();
  };
  int k = 0;
  for (const int other : {1, 2})
    if (length(other) > length(k)) k = other;
  return {t[k], t[(k + 1) % 3], t[(k + 2) % 3]};
}

int CornerBeside(const Eigen::Vector3i& t, int a, int b) {
  for (const int corner : t)
    if (corner != a && corner != b) return corner;
  return -1;
}

/// Joins each flat triangle with what lies across its longest edge and cuts the two the other way
/// (an edge flip), until none is flat or none can be joined. The surface stays where it is.
class Flipper {
 public:
  explicit Flipper(TriangleMesh* mesh) : mesh_(*mesh) {
    for (int i = 0; i < static_cast<int>(mesh_.triangles.size()); ++i) Enter(i);
  }

  void Run() {
    for (int i = 0; i < static_cast<int>(mesh_.triangles.size()); ++i)
      if (Flat(i)) open_.push_back(i);
    // Each flip leaves one flat triangle less, or shorter ones; rounding shall not make it endless.
    std::size_t most = 64 * open_.size();
    while (!open_.empty() && most-- > 0) {
      const int i = open_.back();
      open_.pop_back();
      if (Flat(i)) Flip(i);
    }
  }

 private:
  using Edge = std::pair<int, int>;  // from, to

  bool Flat(int i) const { return IsFlat(mesh_, mesh_.triangles[static_cast<std::size_t>(i)]); }
  Eigen::Vector3i& At(int i) { return mesh_.triangles[static_cast<std::size_t>(i)]; }

  void Enter(int i) {
    for (int k = 0; k < 3; ++k) of_edge_.emplace(Edge(At(i)[k], At(i)[(k + 1) % 3]), i);
  }
  void Replace(int i, const Eigen::Vector3i& with) {
    for (int k = 0; k < 3; ++k) {
      const auto [begin, end] = of_edge_.equal_range({At(i)[k], At(i)[(k + 1) % 3]});
      of_edge_.erase(
          std::find_if(begin, end, [i](const auto& entry) { return entry.second == i; }));
    }
    At(i) = with;
    Enter(i);
  }

  /// The triangle across an edge that a flat one is to be joined with, or -1: one with an area, or
  /// a flat one with the same long edge.
  int Across(const Turned& flat) {
    const auto [begin, end] = of_edge_.equal_range({flat.b, flat.a});
    int found = -1;
    for (auto it = begin; it != end; ++it) {
      if (!Flat(it->second)) return it->second;
      const Turned other = LongEdgeFirst(mesh_, At(it->second));
      if (other.a == flat.b && other.b == flat.a && other.c != flat.c) found = it->second;
    }
    return found;
  }

  void Flip(int i) {
    const Turned t = LongEdgeFirst(mesh_, At(i));
    const int across = Across(t);
    if (across < 0) return;  // it comes again when what is across has been flipped
    const int x = CornerBeside(At(across), t.a, t.b);
    Replace(i, {t.c, t.a, x});
    Replace(across, {t.b, t.c, x});
    for (const int changed : {i, across}) {
      open_.push_back(changed);
      const Eigen::Vector3i now = At(changed);
      for (int k = 0; k < 3; ++k) {
        const auto [begin, end] = of_edge_.equal_range({now[(k + 1) % 3], now[k]});
        for (auto it = begin; it != end; ++it)
          if (Flat(it->second)) open_.push_back(it->second);
      }
    }
  }

  TriangleMesh& mesh_;
  std::multimap<Edge, int> of_edge_;
  std::vector<int> open_;
};

}  // namespace

bool IsFlat(const TriangleMesh& mesh, const Eigen::Vector3i& t) {
  const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return (b - a).cross(c - a).norm() < 1e-3 * kWeld * longest;
}

void FlipFlat(TriangleMesh* mesh) { Flipper(mesh).Run(); }

}  // namespace regrasp
