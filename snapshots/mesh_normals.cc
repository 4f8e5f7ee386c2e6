#include "snapshots/mesh_normals.h"

#include <cmath>

namespace regrasp {

std::vector<std::array<Vector3d, 3>> CornerNormals(const std::vector<Vector3d>& vertices,
                                                   const std::vector<Eigen::Vector3i>& triangles) {
  static const double kSharp = std::cos(35 * M_PI / 180);
  std::vector<Vector3d> areas, normals;                 // of the faces
  std::vector<std::size_t> begin(vertices.size() + 1);  // of a vertex's faces in `about`
  for (const Eigen::Vector3i& t : triangles) {
    const Vector3d& p = vertices[static_cast<std::size_t>(t[0])];
    areas.push_back((vertices[static_cast<std::size_t>(t[1])] - p)
                        .cross(vertices[static_cast<std::size_t>(t[2])] - p));
    normals.push_back(areas.back().normalized());
    for (const int v : t) ++begin[static_cast<std::size_t>(v) + 1];
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) begin[v + 1] += begin[v];
  std::vector<std::size_t> about(3 * triangles.size()), next(begin);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const int v : triangles[i]) about[next[static_cast<std::size_t>(v)]++] = i;
  std::vector<std::array<Vector3d, 3>> corners(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      Vector3d sum = Vector3d::Zero();
      const auto v = static_cast<std::size_t>(triangles[i][k]);
      for (std::size_t a = begin[v]; a < begin[v + 1]; ++a)
        if (normals[about[a]].dot(normals[i]) > kSharp) sum += areas[about[a]];
      corners[i][static_cast<std::size_t>(k)] = sum.normalized();
    }
  return corners;
}

}  // namespace regrasp
