#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <string>

#include "core/hand/mesh.h"
#include "core/hand/scenario.h"

namespace regrasp {
namespace {

std::vector<std::string> Zoo() {
  std::vector<std::string> zoo;
  for (const std::string& name : ListObjects(ModelSearchPath()))
    if (name.starts_with("zoo_")) zoo.push_back(name);
  return zoo;
}

/// Second moments of the solid about its centroid give its inertia by another route than the
/// script's.
TEST(Zoo, IsClosedInsideItsSizesAndOfUniformDensity) {
  const auto zoo = Zoo();
  EXPECT_GE(zoo.size(), 24u);
  for (const std::string& name : zoo) {
    SCOPED_TRACE(name);
    const ObjectModel object = LoadObject(name, ModelSearchPath());  // throws where it is open
    ASSERT_EQ(object.kind, ObjectModel::Kind::kMesh);
    EXPECT_EQ(object.mass, 0.08);
    EXPECT_EQ(object.friction, 0.8);
    EXPECT_GE(object.triangles.size(), 300u);
    EXPECT_LE(object.triangles.size(), 1500u);
    Vector3d low = object.vertices_O[0], high = low;
    for (const Vector3d& p : object.vertices_O) low = low.cwiseMin(p), high = high.cwiseMax(p);
    EXPECT_GE((high - low).minCoeff(), 0.030);
    EXPECT_LE((high - low).maxCoeff(), 0.066 + 1e-6);
    double volume = 0;
    Vector3d first = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();
    for (const Eigen::Vector3i& t : object.triangles) {
      Matrix3d corners;
      for (int k = 0; k < 3; ++k) corners.col(k) = object.vertices_O[t[k]];
      // The integral of x xᵀ over the tetrahedron from the origin, from its midpoint rule.
      const double v = corners.determinant() / 6;
      const Vector3d sum = corners.rowwise().sum();
      volume += v;
      first += v / 4 * sum;
      second += v / 20 * (corners * corners.transpose() + sum * sum.transpose());
    }
    EXPECT_GT(volume, 20e-6);
    EXPECT_LT((first / volume).norm(), 2e-7);  // vertices carry 1e-7 m
    const Matrix3d inertia = 0.08 / volume * (second.trace() * Matrix3d::Identity() - second);
    EXPECT_LT((inertia - object.I_OCom).norm(), 1e-4 * inertia.norm());
  }
}

}  // namespace
}  // namespace regrasp
