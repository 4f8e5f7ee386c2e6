#include "core/hand/primitive_mesh.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/common/box_corners.h"

namespace regrasp {

TriangleMesh BoxMesh(const Vector3d& size) {
  TriangleMesh mesh;
  std::ranges::copy(BoxCorners(size / 2), std::back_inserter(mesh.vertices));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh CylinderMesh(double radius, double half_length) {
  const double corner = radius + kFacet / 2;
  const double half_angle = std::acos(1 - std::min(0.5, kFacet / corner));
  const int around = 4 * std::clamp(static_cast<int>(std::ceil(M_PI / 4 / half_angle)), 3, 120);
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, -half_length}, {0, 0, half_length}};
  for (int i = 0; i < around; ++i) {
    const double a = 2 * M_PI * i / around;
    for (const double z : {-half_length, half_length})
      mesh.vertices.emplace_back(corner * std::cos(a), corner * std::sin(a), z);
    const int low = 2 + 2 * i, next = 2 + 2 * ((i + 1) % around);
    mesh.triangles.emplace_back(0, next, low);
    mesh.triangles.emplace_back(1, low + 1, next + 1);
    mesh.triangles.emplace_back(low, next, low + 1);
    mesh.triangles.emplace_back(next, next + 1, low + 1);
  }
  return mesh;
}

TriangleMesh CapsuleMesh(double radius, double half_length) {
  // A chord of the angle 2 a lies r (1 - cos a) inside the circle through its ends; the middle of a
  // facet that is bent in two directions twice that.
  const double corner = radius + kFacet / 2;
  const double half_angle = std::acos(1 - std::min(0.5, kFacet / (2 * corner)));
  const int quarter = std::clamp(static_cast<int>(std::ceil(M_PI / 4 / half_angle)), 3, 60);
  const int around = 4 * quarter;
  // Rings from the lower pole to the upper one; the equator twice where there is a tube.
  TriangleMesh mesh;
  const auto ring = [&](int k, double z) {
    const double latitude = M_PI / 2 * k / quarter;
    for (int i = 0; i < around; ++i) {
      const double a = 2 * M_PI * i / around;
      mesh.vertices.emplace_back(corner * std::cos(latitude) * std::cos(a),
                                 corner * std::cos(latitude) * std::sin(a),
                                 corner * std::sin(latitude) + z);
    }
  };
  mesh.vertices.emplace_back(0, 0, -corner - half_length);
  for (int k = 1 - quarter; k <= 0; ++k) ring(k, -half_length);
  for (int k = half_length > 0 ? 0 : 1; k < quarter; ++k) ring(k, half_length);
  const int rings = (static_cast<int>(mesh.vertices.size()) - 1) / around;
  const int top = static_cast<int>(mesh.vertices.size());
  mesh.vertices.emplace_back(0, 0, corner + half_length);
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around, last = 1 + (rings - 1) * around;
    mesh.triangles.emplace_back(0, 1 + next, 1 + i);
    mesh.triangles.emplace_back(top, last + i, last + next);
    for (int r = 0; r + 1 < rings; ++r) {
      const int low = 1 + r * around, high = low + around;
      mesh.triangles.emplace_back(low + i, low + next, high + i);
      mesh.triangles.emplace_back(low + next, high + next, high + i);
    }
  }
  return mesh;
}

}  // namespace regrasp
