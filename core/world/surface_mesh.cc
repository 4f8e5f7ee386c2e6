#include "core/world/surface_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/world/last_mesh.h"

namespace regrasp {
namespace {

constexpr int kLeafSize = 4;

struct PointPair {
  Vector3d on_segment;
  Vector3d on_triangle;
};

/// A pair whose second point is so far along an edge of a triangle, from 0 to 1.
struct EdgePair : PointPair {
  double along;
};

double AngleBetween(const Vector3d& u, const Vector3d& v) {
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

double Clamp01(double x) { return std::clamp(x, 0.0, 1.0); }

double SquaredDistanceToSegment(const Vector3d& p, const Vector3d& a, const Vector3d& ab,
                                double ab2) {
  const double t = ab2 > 0 ? Clamp01((p - a).dot(ab) / ab2) : 0;
  return (a + t * ab - p).squaredNorm();
}

// Closest points of the segments a + s u and c + t v, s and t in [0, 1]
// [Ericson, Real-Time Collision Detection, 5.1.9].
EdgePair ClosestOfSegments(const Vector3d& a, const Vector3d& u, const Vector3d& c,
                           const Vector3d& v) {
  const Vector3d r = a - c;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), vr = v.dot(r);
  double s = 0, t = 0;
  if (uu <= 0) {
    t = Clamp01(vr / vv);
  } else {
    const double ur = u.dot(r), uv = u.dot(v);
    const double denominator = uu * vv - uv * uv;
    if (denominator > 1e-12 * uu * vv) s = Clamp01((uv * vr - ur * vv) / denominator);
    t = (uv * s + vr) / vv;
    if (t < 0 || t > 1) {
      t = Clamp01(t);
      s = Clamp01((uv * t - ur) / uu);
    }
  }
  return {{a + s * u, c + t * v}, t};
}

bool InsidePrism(const Vector3d& p, const Vector3d (&v)[3], const Vector3d& normal) {
  for (int k = 0; k < 3; ++k) {
    const Vector3d& from = v[k];
    if ((v[(k + 1) % 3] - from).cross(p - from).dot(normal) < 0) return false;
  }
  return true;
}

/// The mean normals at the edges and corners of a mesh (SurfaceMesh::Closest::outward_O).
class OutwardNormals {
 public:
  explicit OutwardNormals(const std::vector<Vector3d>& vertices)
      : vertices_(vertices), at_corner_(vertices.size(), Vector3d::Zero()) {}

  /// What a triangle adds at its corner `k` and at the edge that runs from there to the next one.
  /// True where it is the first of that edge.
  bool Add(const Eigen::Vector3i& corners, int k, const Vector3d& normal) {
    const int from = corners[k], to = corners[(k + 1) % 3], last = corners[(k + 2) % 3];
    at_corner_[from] +=
        normal * AngleBetween(vertices_[to] - vertices_[from], vertices_[last] - vertices_[from]);
    const auto [edge, is_new] = at_edge_.try_emplace(std::minmax(from, to), Vector3d::Zero());
    edge->second += normal;
    return is_new;
  }

  /// `normal` where what meets there cancels.
  Vector3d AtEdge(int from, int to, const Vector3d& normal) const {
    return Direction(at_edge_.at(std::minmax(from, to)), normal);
  }
  Vector3d AtCorner(int corner, const Vector3d& normal) const {
    return Direction(at_corner_[corner], normal);
  }

 private:
  static Vector3d Direction(const Vector3d& sum, const Vector3d& otherwise) {
    constexpr double kCancelled = 1e-6;
    return sum.norm() > kCancelled ? Vector3d(sum.normalized()) : otherwise;
  }

  const std::vector<Vector3d>& vertices_;
  std::map<std::pair<int, int>, Vector3d> at_edge_;  // sums of normals
  std::vector<Vector3d> at_corner_;
};

}  // namespace

SurfaceMesh::SurfaceMesh(const std::vector<Vector3d>& vertices_O,
                         const std::vector<Eigen::Vector3i>& triangles) {
  OutwardNormals outward(vertices_O);
  std::vector<Eigen::Vector3i> corners;  // of triangles_, as indices of vertices
  for (const Eigen::Vector3i& t : triangles) {
    Triangle triangle;
    for (int k = 0; k < 3; ++k) triangle.v[k] = vertices_O[t[k]];
    const Vector3d n = (triangle.v[1] - triangle.v[0]).cross(triangle.v[2] - triangle.v[0]);
    if (n.norm() <= 0) continue;  // a sliver has no area to touch
    triangle.normal = n.normalized();
    // Two triangles share an edge; only the first one needs to test it.
    for (int k = 0; k < 3; ++k) triangle.owns_edge[k] = outward.Add(t, k, triangle.normal);
    triangles_.push_back(triangle);
    corners.push_back(t);
  }
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    Triangle& t = triangles_[i];
    for (int k = 0; k < 3; ++k) {
      t.edge_normal[k] = outward.AtEdge(corners[i][k], corners[i][(k + 1) % 3], t.normal);
      t.corner_normal[k] = outward.AtCorner(corners[i][k], t.normal);
    }
  }
  nodes_.emplace_back();
  Build(0, 0, static_cast<int>(triangles_.size()));
}

std::shared_ptr<const SurfaceMesh> SurfaceMesh::Shared(
    const std::vector<Vector3d>& vertices_O, const std::vector<Eigen::Vector3i>& triangles) {
  static LastMesh<SurfaceMesh> last;
  return last.Of(vertices_O, triangles);
}

void SurfaceMesh::Build(int node, int begin, int end) {
  Eigen::AlignedBox3d box;
  for (int i = begin; i < end; ++i)
    for (const Vector3d& v : triangles_[i].v) box.extend(v);
  const Vector3d centre = box.center();
  double radius = 0;
  for (int i = begin; i < end; ++i)
    for (const Vector3d& v : triangles_[i].v) radius = std::max(radius, (v - centre).norm());
  nodes_[node] = {centre, radius, begin, end - begin};
  if (end - begin <= kLeafSize) return;

  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  const auto at = [axis](const Triangle& t) { return t.v[0][axis] + t.v[1][axis] + t.v[2][axis]; };
  std::stable_sort(triangles_.begin() + begin, triangles_.begin() + end,
                   [&](const Triangle& a, const Triangle& b) { return at(a) < at(b); });
  const int children = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = children;
  nodes_[node].count = 0;
  Build(children, begin, middle);
  Build(children + 1, middle, end);
}

std::optional<SurfaceMesh::Closest> SurfaceMesh::ClosestToSegment(const Vector3d& a_O,
                                                                  const Vector3d& b_O,
                                                                  double max_distance) const {
  const Vector3d ab = b_O - a_O;
  const double ab2 = ab.squaredNorm();
  double best2 = max_distance * max_distance;
  double best = max_distance;
  PointPair pair{};
  const Vector3d* outward = nullptr;

  const auto offer = [&](const PointPair& candidate, const Vector3d& normal) {
    const double d2 = (candidate.on_segment - candidate.on_triangle).squaredNorm();
    if (d2 >= best2) return;
    best2 = d2;
    best = std::sqrt(d2);
    pair = candidate;
    outward = &normal;
  };
  const auto visit = [&](int i) {
    const Triangle& t = triangles_[i];
    const double ha = (a_O - t.v[0]).dot(t.normal), hb = (b_O - t.v[0]).dot(t.normal);
    if (std::min(std::abs(ha), std::abs(hb)) >= best && ha * hb > 0) return;
    if (ha * hb < 0) {  // the segment may pierce the triangle
      const Vector3d x = a_O + ab * (ha / (ha - hb));
      if (InsidePrism(x, t.v, t.normal)) return offer({x, x}, t.normal);
    }
    const Vector3d foot_a = a_O - ha * t.normal, foot_b = b_O - hb * t.normal;
    if (InsidePrism(foot_a, t.v, t.normal)) offer({a_O, foot_a}, t.normal);
    if (InsidePrism(foot_b, t.v, t.normal)) offer({b_O, foot_b}, t.normal);
    for (int k = 0; k < 3; ++k) {
      if (!t.owns_edge[k]) continue;
      const int next = (k + 1) % 3;
      const EdgePair edge = ClosestOfSegments(a_O, ab, t.v[k], t.v[next] - t.v[k]);
      offer(edge, edge.along <= 0   ? t.corner_normal[k]
                  : edge.along >= 1 ? t.corner_normal[next]
                                    : t.edge_normal[k]);
    }
  };

  struct Open {
    int node;
    double bound;
  };
  const auto bound_of = [&](int node) {
    const Node& n = nodes_[node];
    return std::sqrt(SquaredDistanceToSegment(n.centre, a_O, ab, ab2)) - n.radius;
  };
  std::array<Open, 64> stack;  // depth of a median-split tree: log2 of the number of triangles
  std::size_t size = 0;
  stack[size++] = {0, bound_of(0)};
  while (size > 0) {
    const Open open = stack[--size];
    if (open.bound >= best) continue;
    const Node& node = nodes_[open.node];
    for (int i = node.first; i < node.first + node.count; ++i) visit(i);
    if (node.count > 0) continue;
    Open near{node.first, bound_of(node.first)};
    Open far{node.first + 1, bound_of(node.first + 1)};
    if (far.bound < near.bound) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
  if (outward == nullptr) return std::nullopt;
  return Closest{pair.on_segment, pair.on_triangle, *outward, best};
}

}  // namespace regrasp
