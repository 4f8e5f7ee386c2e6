// The felt surface as a closed mesh.

#include "core/shape/felt_mesh.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

namespace regrasp {
namespace {

FeltSurface Ball(double radius) {
  FeltSurface felt;
  for (int i = 0; i < FeltSurface::kCells; ++i) {
    const Vector3d d = FeltSurface::CellDirection(i);
    for (int k = 0; k < ShapeParameters().full; ++k) felt.Add(radius * d, d);
  }
  return felt;
}

TEST(FeltMesh, IsClosedAndFacesOutwards) {
  const FeltMesh mesh = MeshOf(Ball(0.03), 3);
  EXPECT_EQ(mesh.vertices.size(), 642u);
  EXPECT_EQ(mesh.triangles.size(), 1280u);
  std::map<std::pair<int, int>, int> edges;  // directed: each once, and once the other way round
  double volume = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    volume +=
        mesh.vertices[t[0]].p_O.dot(mesh.vertices[t[1]].p_O.cross(mesh.vertices[t[2]].p_O)) / 6;
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  const double ball = 4.0 / 3.0 * std::numbers::pi * std::pow(0.03, 3);
  EXPECT_NEAR(volume, ball, 0.02 * ball);
  for (const SurfacePoint& point : mesh.vertices) {
    EXPECT_NEAR(point.p_O.norm(), 0.03, 1e-5);
    EXPECT_LT(point.unknown, 0.15);
  }
}

TEST(FeltMesh, TellsWhatIsUnknown) {
  FeltSurface felt;
  for (int k = 0; k < ShapeParameters().full; ++k) felt.Add({0, 0, 0.02}, Vector3d::UnitZ());
  const FeltMesh mesh = MeshOf(felt, 0);
  EXPECT_NEAR(mesh.vertices.front().unknown, 0, 1e-6);                // the upper pole
  EXPECT_NEAR(mesh.vertices.back().unknown, std::numbers::pi, 1e-6);  // the lower one
}

}  // namespace
}  // namespace regrasp
