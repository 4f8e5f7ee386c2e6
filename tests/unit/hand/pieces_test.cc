/// Objects of several <collision> elements: primitives and meshes as one body.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/hand/primitive_mesh.h"
#include "core/hand/solid.h"
#include "core/hand/urdf.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

/// Several <collision> elements, each an <origin> and a shape.
std::string Collisions(const std::vector<std::pair<std::string, std::string>>& shapes) {
  std::string text;
  for (const auto& [origin, shape] : shapes)
    text +=
        fmt::format("<collision><origin {}/><geometry>{}</geometry></collision>", origin, shape);
  return text;
}

class PiecesTest : public LoaderTest {
 protected:
  ObjectModel Of(const std::string& collisions, const LoadOptions& options = {},
                 ObjectFacts* facts = nullptr, const std::string& com = "0 0 0") {
    Write(
        "objects/thing.urdf",
        R"(<robot name="t"><link name="object"><inertial><origin xyz=")" + com +
            R"("/><mass value="0.08"/><inertia ixx="3e-5" ixy="0" ixz="0" iyy="3e-5" iyz="0" izz="3e-5"/></inertial>)" +
            collisions + "</link></robot>");
    return LoadObjectUrdf(root_ / "objects/thing.urdf", options, nullptr, facts);
  }
  static Vector3d Extent(const ObjectModel& object) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& v : object.vertices_O) box.extend(v);
    return box.sizes();
  }
  LoadOptions shape_;
  void SetUp() override { shape_.inertia_from_shape = true; }
};

TEST_F(PiecesTest, OnePrimitiveStaysWhatItIsWhereItCan) {
  using Kind = ObjectModel::Kind;
  EXPECT_EQ(Of(Collisions({{"rpy=\"1 2 3\"", "<sphere radius=\"0.03\"/>"}})).kind, Kind::kSphere);
  EXPECT_EQ(Of(Collisions({{"rpy=\"0 0 0\"", "<box size=\"0.04 0.05 0.06\"/>"}})).kind, Kind::kBox);
  EXPECT_EQ(
      Of(Collisions({{"xyz=\"0 0 0.01\"", "<sphere radius=\"0.03\"/>"}}), {}, nullptr, "0 0 0.01")
          .kind,
      Kind::kSphere);
  // Lying, and beside the centre of mass: the same surface by facets.
  const ObjectModel lying = Of(Collisions(
      {{"rpy=\"0 1.5707963267948966 0\"", "<cylinder radius=\"0.02\" length=\"0.04\"/>"}}));
  EXPECT_EQ(lying.kind, Kind::kMesh);
  EXPECT_LT((Extent(lying) - Vector3d(0.04, 0.04, 0.04)).norm(), 2 * kFacet);
  ObjectFacts facts;
  const ObjectModel beside =
      Of(Collisions({{"", "<sphere radius=\"0.03\"/>"}}), {}, &facts, "0.005 0 0");
  EXPECT_EQ(beside.kind, Kind::kMesh);
  EXPECT_NEAR(beside.bounding_radius, 0.035, kFacet);
  EXPECT_EQ(facts.p_LCom, Vector3d(0.005, 0, 0));
}

TEST_F(PiecesTest, ACylinderHasFlatEnds) {
  // A tin: no round ends are added to what is 100 mm long, and its body is that of a cylinder.
  ObjectFacts facts;
  const ObjectModel tin =
      Of(Collisions({{"", "<cylinder radius=\"0.033\" length=\"0.1\"/>"}}), shape_, &facts);
  EXPECT_LT((Extent(tin) - Vector3d(0.066, 0.066, 0.1)).norm(), 2 * kFacet);
  const double across = 0.08 * (3 * 0.033 * 0.033 + 0.1 * 0.1) / 12;
  EXPECT_NEAR(tin.I_OCom(0, 0), across, 2e-3 * across);
  EXPECT_NEAR(tin.I_OCom(2, 2), 0.08 * 0.033 * 0.033 / 2, 2e-3 * 0.08 * 0.033 * 0.033 / 2);
  EXPECT_NEAR(ObjectSolid(tin).volume, M_PI * 0.033 * 0.033 * 0.1, 2e-3 * 3.4e-4);
  for (const Vector3d& v : CylinderMesh(0.033, 0.05).vertices)
    EXPECT_NEAR(std::abs(v.z()), 0.05, 1e-15);
}

TEST_F(PiecesTest, FacetsLieAboutTheRoundSurface) {
  for (const double half_length : {0.0, 0.02}) {
    const TriangleMesh mesh = CapsuleMesh(0.03, half_length);
    double least = 1, most = 0;
    const auto add = [&](Vector3d p) {
      p.z() -= std::clamp(p.z(), -half_length, half_length);
      least = std::min(least, p.norm());
      most = std::max(most, p.norm());
    };
    for (const Vector3d& v : mesh.vertices) add(v);
    for (const auto& t : mesh.triangles)
      add((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3);
    EXPECT_GT(least, 0.03 - kFacet);
    EXPECT_LT(most, 0.03 + kFacet);
    TriangleMesh closed = mesh;
    EXPECT_NO_THROW(CloseMesh("capsule", false, &closed));
    const Solid solid = MeshSolid(mesh), exact = CapsuleSolid(0.03, half_length);
    EXPECT_NEAR(solid.volume, exact.volume, 2e-3 * exact.volume);
    EXPECT_LT((solid.inertia - exact.inertia).norm(), 4e-3 * exact.inertia.norm());
  }
}

TEST_F(PiecesTest, PartsFarFromEachOtherAreTold) {
  const auto told = [&](double at, double up = 0.02) {
    Of(Collisions({{fmt::format("xyz=\"{} 0 0\"", -at), "<box size=\"0.02 0.02 0.02\"/>"},
                   {"", "<box size=\"0.02 0.02 0.02\"/>"},
                   {fmt::format("xyz=\"0 0 {}\"", up), "<sphere radius=\"0.01\"/>"}}),
       shape_);
    ModelReport report;
    LoadObjectUrdf(root_ / "objects/thing.urdf", shape_, &report);
    return report.warnings.empty() ? "" : report.warnings.front().text;
  };
  EXPECT_EQ(told(0.0205), "") << "half a millimetre is a gap of rounding";
  EXPECT_EQ(told(0.1), "2 parts that do not touch, 80 mm apart: one rigid body all the same");
  EXPECT_EQ(told(0.1, 0.025),
            "3 parts that do not touch, 4.99 mm apart: one rigid body all the same")
      << "the second and the third (a ball of triangles, a little larger), not the first";
}

TEST_F(PiecesTest, PrimitivesThatTouchAddUp) {
  // A dumb-bell of two balls and a box between them, which only touch it in a point.
  ObjectFacts facts;
  const ObjectModel object = Of(Collisions({{"xyz=\"-0.03 0 0\"", "<sphere radius=\"0.02\"/>"},
                                            {"", "<box size=\"0.02 0.02 0.02\"/>"},
                                            {"xyz=\"0.03 0 0\"", "<sphere radius=\"0.02\"/>"}}),
                                shape_, &facts);
  EXPECT_EQ(facts.collisions, 3);
  EXPECT_EQ(facts.pieces, 3);
  EXPECT_EQ(facts.overlap_m3, 0);
  EXPECT_LT(facts.p_LCom.norm(), 1e-6);
  EXPECT_LT((Extent(object) - Vector3d(0.10, 0.04, 0.04)).norm(), 3 * kFacet);
  const Solid ball = SphereSolid(0.02), box = BoxSolid(Vector3d::Constant(0.01));
  const double density = 0.08 / (2 * ball.volume + box.volume);
  const double along = density * (2 * ball.inertia(0, 0) + box.inertia(0, 0));
  EXPECT_NEAR(object.I_OCom(0, 0), along, 5e-3 * along);
  EXPECT_NEAR(object.I_OCom(1, 1), along + density * 2 * ball.volume * 0.03 * 0.03,
              5e-3 * object.I_OCom(1, 1));
}

TEST_F(PiecesTest, WhereTheyOverlapTheBodyIsThereOnce) {
  // Two bars of 20 x 20 x 80 mm that cross: 8 cm³ are in both.
  ObjectFacts facts;
  const ObjectModel cross = Of(
      Collisions({{"", "<box size=\"0.08 0.02 0.02\"/>"}, {"", "<box size=\"0.02 0.08 0.02\"/>"}}),
      shape_, &facts);
  EXPECT_NEAR(facts.overlap_m3, 8e-6, 1e-7);
  const Solid solid = ObjectSolid(cross);
  EXPECT_NEAR(solid.volume, 56e-6, 56e-6 * 2e-3);
  // As one bar and two stubs of 30 mm, 25 mm off the middle.
  const Solid bar = BoxSolid({0.04, 0.01, 0.01}), stub = BoxSolid({0.01, 0.015, 0.01});
  const double density = 0.08 / 56e-6;
  const double about_z =
      density * (bar.inertia(2, 2) + 2 * (stub.inertia(2, 2) + stub.volume * 0.025 * 0.025));
  EXPECT_NEAR(cross.I_OCom(2, 2), about_z, 5e-3 * about_z);
  // A ball around a ball adds nothing, wherever the columns run.
  const ObjectModel ball = Of(Collisions({{"xyz=\"0 0 0.002\"", "<sphere radius=\"0.012\"/>"},
                                          {"", "<sphere radius=\"0.02\"/>"}}),
                              shape_, &facts);
  EXPECT_NEAR(ObjectSolid(ball).volume, SphereSolid(0.02).volume, 3e-3 * SphereSolid(0.02).volume);
  EXPECT_LT(facts.p_LCom.norm(), 2e-5);
}

TEST_F(PiecesTest, InsideIsInsideAnyPiece) {
  const ObjectModel cross = Of(
      Collisions({{"", "<box size=\"0.08 0.02 0.02\"/>"}, {"", "<box size=\"0.02 0.08 0.02\"/>"}}));
  const auto inside = [&](double x, double y, double z) {
    return IsInside(cross.vertices_O, cross.triangles, Vector3d(x, y, z));
  };
  EXPECT_TRUE(inside(0.001, 0.002, 0.003));  // in both
  EXPECT_TRUE(inside(0.011, 0.001, 0));      // in one, a millimetre beyond a face of the other
  EXPECT_TRUE(inside(0.001, -0.039, 0.009));
  EXPECT_FALSE(inside(0.02, 0.02, 0));  // between the bars
  EXPECT_FALSE(inside(0.041, 0, 0));
}

TEST_F(PiecesTest, AnObjectIsTurnedBeforeItIsPresented) {
  const std::string shapes = Collisions({{"xyz=\"0 0.01 0\"", "<box size=\"0.06 0.02 0.04\"/>"},
                                         {"xyz=\"0 -0.01 0\"", "<box size=\"0.03 0.02 0.04\"/>"}});
  const ObjectModel straight = Of(shapes, shape_);
  Write("objects/thing.toml",
        "rotation_deg = [0, 0, 90]\nfriction = 0.5\ninertia_from_shape = true\n");
  ObjectFacts facts;
  const ObjectModel turned = LoadObjectFile(root_ / "objects/thing.urdf", {}, nullptr, &facts);
  EXPECT_EQ(turned.friction, 0.5);
  EXPECT_LT((Extent(straight) - Vector3d(0.06, 0.04, 0.04)).norm(), 1e-12);
  EXPECT_LT((Extent(turned) - Vector3d(0.04, 0.06, 0.04)).norm(), 1e-12);
  // x becomes y, y becomes -x; the centre of mass is told in the file's axes. The pieces touch and
  // do not overlap, so that nothing here is sampled.
  EXPECT_LT(
      (turned.vertices_O[0] - Vector3d(-straight.vertices_O[0].y(), straight.vertices_O[0].x(),
                                       straight.vertices_O[0].z()))
          .norm(),
      1e-12);
  EXPECT_NEAR(turned.I_OCom(1, 1), straight.I_OCom(0, 0), 1e-15);
  EXPECT_LT((facts.p_LCom - Vector3d(0, 0.01 / 3, 0)).norm(), 1e-12);
}

TEST_F(PiecesTest, EveryPieceIsCheckedAndAllErrorsComeAtOnce) {
  Write("objects/open.obj", Replaced(kTetrahedron, "f 2 3 4\n", "f 2 4 3\n"));
  try {
    Of(Collisions({{"", "<mesh filename=\"open.obj\"/>"},
                   {"", "<sphere radius=\"0.02\"/>"},
                   {"", "<mesh filename=\"gone.obj\"/>"}}));
    ADD_FAILURE() << "was not refused";
  } catch (const ModelError& error) {
    for (const char* word :
         {"2 errors", "turned against their neighbours", "gone.obj: mesh file not found"})
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace regrasp
