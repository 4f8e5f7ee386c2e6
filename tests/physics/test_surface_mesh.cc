#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/common/random.h"
#include "core/hand/mesh.h"
#include "core/world/surface_mesh.h"

namespace regrasp {
namespace {

// A unit cube about the origin, as 12 triangles: exact distances are easy.
const std::vector<Vector3d> kCorners = {{-.5, -.5, -.5}, {.5, -.5, -.5}, {.5, .5, -.5},
                                        {-.5, .5, -.5},  {-.5, -.5, .5}, {.5, -.5, .5},
                                        {.5, .5, .5},    {-.5, .5, .5}};
const std::vector<Eigen::Vector3i> kFaces = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7},
                                             {0, 1, 5}, {0, 5, 4}, {3, 7, 6}, {3, 6, 2},
                                             {0, 4, 7}, {0, 7, 3}, {1, 2, 6}, {1, 6, 5}};

double DistanceToCube(const Vector3d& p) {
  return (p.cwiseAbs() - Vector3d::Constant(0.5)).cwiseMax(0.0).norm();
}

TEST(SurfaceMesh, PointDistanceIsTheBoxDistance) {
  const SurfaceMesh mesh(kCorners, kFaces);
  RandomStream random(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = random.Normal3();
    if (p.cwiseAbs().maxCoeff() < 0.5) continue;  // outside only
    const auto closest = mesh.ClosestToSegment(p, p, 10);
    ASSERT_TRUE(closest);
    EXPECT_NEAR(closest->distance, DistanceToCube(p), 1e-12);
    EXPECT_NEAR((closest->p_OSurface - p).norm(), closest->distance, 1e-12);
    EXPECT_NEAR(closest->p_OSurface.cwiseAbs().maxCoeff(), 0.5, 1e-12) << "lies on the surface";
  }
}

TEST(SurfaceMesh, SegmentDistanceIsTheLeastOverItsPoints) {
  const SurfaceMesh mesh(kCorners, kFaces);
  RandomStream random(2, 0);
  for (int i = 0; i < 300; ++i) {
    const Vector3d a = 1.2 * random.Normal3(), b = a + random.Normal3();
    double least = 1e9;
    const int n = 2000;
    for (int k = 0; k <= n; ++k)
      least = std::min(least, DistanceToCube(a + (b - a) * (double(k) / n)));
    if (least < 1e-2) continue;  // touching or piercing: below
    const auto closest = mesh.ClosestToSegment(a, b, 10);
    ASSERT_TRUE(closest);
    // Sampling overestimates by at most half a sample spacing.
    EXPECT_LE(closest->distance, least + 1e-12);
    EXPECT_GT(closest->distance, least - (b - a).norm() / n);
  }
}

TEST(SurfaceMesh, PiercingSegmentHasNoDistance) {
  const SurfaceMesh mesh(kCorners, kFaces);
  const auto closest = mesh.ClosestToSegment({0.1, 0.2, 2}, {0.1, 0.2, 0}, 10);
  ASSERT_TRUE(closest);
  EXPECT_NEAR(closest->distance, 0, 1e-12);
  EXPECT_NEAR(closest->p_OSurface.z(), 0.5, 1e-12);
  EXPECT_NEAR(closest->outward_O.z(), 1, 1e-12);
}

struct Body {
  std::vector<Vector3d> corners;
  std::vector<Eigen::Vector3i> faces;
};
const std::vector<Eigen::Vector3i> kTetrahedron = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};

/// Bodies with edges sharper than a right angle: of the triangles that meet there none alone tells
/// outside from inside.
std::vector<Body> SharpBodies() {
  const Body regular = {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, kTetrahedron};
  const Body blade = {{{0, 0, 2}, {0.1, 0, 0}, {-0.1, 0.1, 0}, {-0.1, -0.1, 0}}, kTetrahedron};
  // The blade again; a fifth corner is on the edge from 0 to 1, which one side does not know of: a
  // triangle without area was between them.
  TriangleMesh cut{.vertices = blade.corners, .triangles = {{0, 4, 2}, {4, 1, 2}, {0, 1, 4}}};
  cut.vertices.push_back(0.6 * blade.corners[0] + 0.4 * blade.corners[1]);
  cut.triangles.insert(cut.triangles.end(), kTetrahedron.begin() + 1, kTetrahedron.end());
  CloseMesh("cut", false, &cut);
  return {regular, blade, {cut.vertices, cut.triangles}};
}

/// A point near the body: a mean of its corners, some of them with a negative weight.
Vector3d PointNear(const Body& body, RandomStream* random) {
  for (;;) {
    Vector3d p = Vector3d::Zero();
    double sum = 0;
    for (const Vector3d& corner : body.corners) {
      const double weight = 1.3 * random->Uniform() - 0.3;
      p += weight * corner, sum += weight;
    }
    if (sum > 0.1) return p / sum;
  }
}

/// Points, or the segments between two points, near sharp bodies.
void ExpectRightSides(bool segments) {
  for (const Body& body : SharpBodies()) {
    const SurfaceMesh mesh(body.corners, body.faces);
    RandomStream random(3, 0);
    int inside = 0, outside = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vector3d a = PointNear(body, &random), b = segments ? PointNear(body, &random) : a;
      const auto closest = mesh.ClosestToSegment(a, b, 100);
      ASSERT_TRUE(closest);
      if (closest->distance < 1e-9) continue;  // on it, or through it
      const Vector3d& p = closest->p_OSegment;
      const bool is_inside = IsInside(body.corners, body.faces, p);
      ++(is_inside ? inside : outside);
      ASSERT_EQ((p - closest->p_OSurface).dot(closest->outward_O) < 0, is_inside)
          << a.transpose() << " to " << b.transpose() << ", nearest "
          << closest->p_OSurface.transpose();
    }
    EXPECT_GT(outside, 100);
    if (!segments) EXPECT_GT(inside, 100);
  }
}

TEST(SurfaceMesh, OutwardTellsTheSideAtSharpEdgesAndCorners) { ExpectRightSides(false); }
TEST(SurfaceMesh, OutwardTellsTheSideOfASegment) { ExpectRightSides(true); }

TEST(SurfaceMesh, IsSharedByAllThatUseTheSameMesh) {
  const auto mesh = SurfaceMesh::Shared(kCorners, kFaces);
  EXPECT_EQ(SurfaceMesh::Shared(std::vector(kCorners), kFaces), mesh);
  std::vector<Vector3d> moved = kCorners;
  moved[6].x() = std::nextafter(moved[6].x(), 1.0);
  const auto other = SurfaceMesh::Shared(moved, kFaces);
  EXPECT_NE(other, mesh);
  const std::vector<Eigen::Vector3i> fewer(kFaces.begin(), kFaces.end() - 1);
  EXPECT_NE(SurfaceMesh::Shared(moved, fewer), other);
  const Vector3d p(0.4, 0.2, 3);  // the first lives on
  EXPECT_EQ(mesh->ClosestToSegment(p, p, 10)->distance, 2.5);
}

TEST(SurfaceMesh, FartherThanAskedIsNothing) {
  const SurfaceMesh mesh(kCorners, kFaces);
  EXPECT_FALSE(mesh.ClosestToSegment({0, 0, 1}, {0, 0, 2}, 0.499));
  EXPECT_TRUE(mesh.ClosestToSegment({0, 0, 1}, {0, 0, 2}, 0.501));
}

}  // namespace
}  // namespace regrasp
