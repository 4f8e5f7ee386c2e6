/// Fingertips that no round end meets, and those whose mesh is not there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/hand/primitive_mesh.h"
#include "core/hand/shape_fit.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

constexpr const char* kTip =
    R"(<origin xyz="0 0 0.01"/><geometry><cylinder radius="0.005" length="0.02"/>)";

TriangleMesh Plate(const Vector3d& size) {
  TriangleMesh mesh = BoxMesh(size);
  for (Vector3d& v : mesh.vertices) v.z() += size.z() / 2;
  return mesh;
}

/// How far a capsule sticks out of the box about a mesh.
double Beyond(const TriangleMesh& mesh, const Shape& shape) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  const Vector3d low = shape.a_L.cwiseMin(shape.b_L), high = shape.a_L.cwiseMax(shape.b_L);
  return std::max((high - box.max()).maxCoeff(), (box.min() - low).maxCoeff()) + shape.radius;
}

TEST(FingertipFit, APlateIsMetByACapsuleOfItsThickness) {
  for (const double t : {0.001, 0.002, 0.003, 0.004, 0.006}) {
    const TriangleMesh mesh = Plate({t, 0.02, 0.03});
    const FittedShape fit = FitFingertip(mesh, Vector3d::UnitZ());
    EXPECT_EQ(fit.kind, "capsule") << t;
    EXPECT_NEAR(fit.shape.radius, t / 2, 1e-4) << t;  // principal axes are not quite the box's
    EXPECT_LT(Beyond(mesh, fit.shape), 5e-4) << t;
    // Its edges are told: 10 mm aside, corners somewhat more.
    EXPECT_GT(fit.error_m, 0.01 - t / 2 - 1e-4) << t;
    EXPECT_LT(fit.error_m, std::hypot(0.01, t / 2, t / 2)) << t;
    EXPECT_GT(fit.shape.b_L.z(), 0.03 - t) << t;  // to the end of the finger
  }
}

TEST(FingertipFit, AnEndThatIsCutOffBehindKeepsItsRoundEnd) {
  TriangleMesh bullet = CapsuleMesh(0.01, 0.01);
  for (Vector3d& v : bullet.vertices) v.z() = std::max(0.0, v.z());
  const FittedShape fit = FitFingertip(bullet, Vector3d::UnitZ());
  EXPECT_FALSE(fit.within);
  EXPECT_NEAR(fit.shape.radius, 0.01, 1e-4);
  EXPECT_LT((fit.shape.b_L - Vector3d(0, 0, 0.01)).norm(), 1e-4);
  EXPECT_LT(fit.error_m, 1e-4);
}

TEST(FingertipFit, AFingerOnAFlangeIsNotAsThickAsTheFlange) {
  TriangleMesh mesh = Plate({0.06, 0.06, 0.004});
  const TriangleMesh finger = Plate({0.01, 0.01, 0.06});
  for (const Vector3d& v : finger.vertices) mesh.vertices.push_back(v);
  for (const Eigen::Vector3i& t : finger.triangles)
    mesh.triangles.push_back(t + Eigen::Vector3i::Constant(8));
  const FittedShape fit = FitFingertip(mesh, Vector3d::UnitZ());
  EXPECT_LT(fit.shape.radius, 0.012);
  EXPECT_NEAR(fit.shape.b_L.z() + fit.shape.radius, 0.06, 1e-3);
  EXPECT_GT(fit.error_m, 0.02);  // the flange is told
}

class FingertipFileTest : public LoaderTest {
 protected:
  /// The warning of the tip's link, "" where there is none.
  std::string Warning(const LoadOptions& options = {}) {
    loaded_ = LoadScenario("mini", "", {root_}, options);
    for (const ModelWarning& warning : loaded_.report.warnings)
      if (warning.element == "link \"tip\"") return warning.text;
    return "";
  }
  LoadedScenario loaded_;
};

TEST_F(FingertipFileTest, AFlatFingertipIsTold) {
  EditHand(kTip, R"(<origin xyz="0 0 0.015"/><geometry><box size="0.001 0.02 0.03"/>)");
  const std::string warning = Warning();
  EXPECT_NE(warning.find("differs from its box by up to 9.5 mm"), std::string::npos) << warning;
  EXPECT_NE(warning.find("it is one within it, of 0.5"), std::string::npos) << warning;
  EXPECT_LT(loaded_.hand.fingers[0].tip_radius, 6e-4);
}

TEST_F(FingertipFileTest, ADiscIsNoBall) {
  EditHand(kTip, R"(<origin xyz="0 0 0.01"/><geometry><cylinder radius="0.02" length="0.004"/>)");
  const std::string warning = Warning();
  EXPECT_NE(warning.find("differs from its cylinder by up to 18 mm"), std::string::npos) << warning;
  EXPECT_NEAR(loaded_.hand.fingers[0].tip_radius, 0.002, 1e-4);
}

TEST_F(FingertipFileTest, AMissingLastLinkIsAsThickAsTheOneBefore) {
  Write("hands/mini.urdf",
        Replaced(Replaced(kHandUrdf, kTip, R"(<geometry><mesh filename="gone.stl"/>)"),
                 R"(<box size="0.01 0.01 0.04"/>)", R"(<box size="0.018 0.018 0.04"/>)"));
  LoadOptions options;
  options.fill_missing_meshes = true;
  const std::string warning = Warning(options);
  EXPECT_NE(warning.find("a ball of 9 mm radius, about as thick as link \"upper\", in its "
                         "place"),
            std::string::npos)
      << warning;
  EXPECT_DOUBLE_EQ(loaded_.hand.fingers[0].tip_radius, 0.009);
}

}  // namespace
}  // namespace regrasp
