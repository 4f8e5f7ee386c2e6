/// What published files hold: meshes as they are exported, bodies that cannot be. Their joints:
/// published_joints_test.cc.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/hand/mesh.h"
#include "core/hand/shape_fit.h"
#include "core/hand/solid.h"
#include "core/hand/urdf.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

/// A brick of 24 x 30 x 60 mm about the origin, as Wavefront text; corners times `unit`.
std::string Brick(double unit = 1, bool inside_out = false) {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += fmt::format("v {} {} {}\n", unit * 0.012 * ((i & 1) ? 1 : -1),
                        unit * 0.015 * ((i & 2) ? 1 : -1), unit * 0.030 * ((i & 4) ? 1 : -1));
  const int faces[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                           {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
  for (const auto& f : faces)
    text += inside_out ? fmt::format("f {} {} {} {}\n", f[3], f[2], f[1], f[0])
                       : fmt::format("f {} {} {} {}\n", f[0], f[1], f[2], f[3]);
  return text;
}

std::string Collada(const std::string& up) {
  std::string positions, triangles;
  const int faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                            {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (int i = 0; i < 8; ++i)
    positions += fmt::format("{} {} {} ", 12 * ((i & 1) ? 1 : -1), 15 * ((i & 2) ? 1 : -1),
                             30 * ((i & 4) ? 1 : -1));
  for (const auto& f : faces) triangles += fmt::format("{} {} {} ", f[0], f[1], f[2]);
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>)" +
         up + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="24">)" +
         positions + R"(</float_array><technique_common><accessor source="#a" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>)" +
         triangles + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="n"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#n"/></scene></COLLADA>)";
}

class PublishedTest : public LoaderTest {
 protected:
  /// An object of 80 g with this <geometry> and moment.
  ObjectModel Object(const std::string& geometry, const LoadOptions& options = {},
                     const std::string& moment = "3e-5", const std::string& more = "") {
    Write(
        "objects/thing.urdf",
        R"(<?xml version="0.0"?><robot name="t"><link name="object"><inertial>)" + more +
            R"(<mass value="0.08"/><inertia ixx=")" + moment + R"(" ixy="0" ixz="0" iyy=")" +
            moment + R"(" iyz="0" izz=")" + moment +
            R"("/></inertial><visual><geometry><mesh filename="gone.obj" scale="x"/></geometry></visual><collision><geometry>)" +
            geometry + "</geometry></collision></link></robot>");
    return LoadObject("thing", {root_}, options);
  }
  std::string Refusal(const std::string& geometry, const LoadOptions& options = {},
                      const std::string& moment = "3e-5", const std::string& more = "") {
    try {
      Object(geometry, options, moment, more);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "taken";
  }
  static Vector3d Extent(const ObjectModel& object) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& v : object.vertices_O) box.extend(v);
    return box.sizes();
  }
};

constexpr double kSingle = 1e-8;  // mesh files are read in single precision
const Vector3d kBrick(0.024, 0.030, 0.060);

TEST_F(PublishedTest, MeshesKeepTheAxesOfTheirFile) {
  Write("objects/a.obj", Brick());
  EXPECT_LT((Extent(Object("<mesh filename=\"a.obj\"/>")) - kBrick).norm(), kSingle);
  for (const char* up : {"X_UP", "Y_UP", "Z_UP"}) {
    Write("objects/a.DAE", Collada(up));
    EXPECT_LT((Extent(Object("<mesh filename=\"a.DAE\"/>")) - kBrick).norm(), kSingle) << up;
  }
}

TEST_F(PublishedTest, MeshesAreMendedBeforeTheyAreJudged) {
  Write("objects/a.obj", Brick() + "f 1 1 2\nf 3 4 3\n");
  EXPECT_EQ(Object("<mesh filename=\"a.obj\"/>").triangles.size(), 12u);
  // Every face with corners of its own, 0.1 um off.
  std::string loose = Brick();
  std::string faces;
  for (int i = 0; i < 8; ++i)
    loose += fmt::format("v {} {} {}\n", 0.0120001 * ((i & 1) ? 1 : -1), 0.015 * ((i & 2) ? 1 : -1),
                         0.030 * ((i & 4) ? 1 : -1));
  loose = Replaced(loose, "f 5 6 8 7", "f 13 14 16 15");
  Write("objects/a.obj", loose);
  EXPECT_EQ(Object("<mesh filename=\"a.obj\"/>").vertices_O.size(), 8u);
}

TEST_F(PublishedTest, AMirroringScaleTurnsFaces) {
  Write("objects/a.obj", Brick());
  Write("objects/b.obj", Brick(1, true));
  for (const char* name : {"a.obj", "b.obj"}) {
    const ObjectModel object =
        Object(fmt::format("<mesh filename=\"{}\" scale=\"1 -1 1\"/>", name));
    EXPECT_NEAR(Volume({object.vertices_O, object.triangles}), kBrick.prod(), 1e-3 * kBrick.prod());
  }
  EXPECT_NE(Refusal("<mesh filename=\"b.obj\"/>").find("counter-clockwise"), std::string::npos);
}

TEST_F(PublishedTest, APieceMayFaceInwardsInAnotherOnly) {
  // Of half the size, turned inside out: in the middle of the first, or beside it.
  const auto with_small = [](double x) {
    std::string text = Brick();
    for (int i = 0; i < 8; ++i)
      text += fmt::format("v {} {} {}\n", x + 0.006 * ((i & 1) ? 1 : -1),
                          0.0075 * ((i & 2) ? 1 : -1), 0.015 * ((i & 4) ? 1 : -1));
    for (const char* face :
         {"10 12 11 9", "15 16 14 13", "13 14 10 9", "12 16 15 11", "11 15 13 9", "14 16 12 10"})
      text += fmt::format("f {}\n", face);
    return text;
  };
  Write("objects/a.obj", with_small(0));
  const ObjectModel hollow = Object("<mesh filename=\"a.obj\"/>");
  EXPECT_NEAR(ObjectSolid(hollow).volume, 7.0 / 8 * kBrick.prod(), 1e-3 * kBrick.prod());
  Write("objects/a.obj", with_small(0.03));
  const std::string refusal = Refusal("<mesh filename=\"a.obj\"/>");
  EXPECT_NE(refusal.find(
                "-0.0075, -0.015) is inside out and no cavity of another: its volume is -5.4e-06"),
            std::string::npos)
      << refusal;
}

TEST_F(PublishedTest, TextBehindAByteOrderMark) {
  const std::string bom = "\xEF\xBB\xBF";
  Write("objects/a.obj", bom + Brick());
  Write("objects/a.dae", bom + Collada("Z_UP"));
  for (const char* name : {"a.obj", "a.dae"})
    EXPECT_LT((Extent(Object(fmt::format("<mesh filename=\"{}\"/>", name))) - kBrick).norm(),
              kSingle)
        << name;
}

TEST_F(PublishedTest, CapitalsOfAFileNameCount) {
  Write("objects/Thing.OBJ", Brick());
  const std::string refusal = Refusal("<mesh filename=\"thing.obj\"/>");
  EXPECT_NE(refusal.find("not found; did you mean Thing.OBJ?"), std::string::npos) << refusal;
  fs::create_directory(root_ / "objects/folder.obj");
  EXPECT_NE(Refusal("<mesh filename=\"folder.obj\"/>").find("is a directory"), std::string::npos);
}

TEST_F(PublishedTest, MillimetresAreFoundBySize) {
  Write("objects/a.obj", Brick(1000));
  const std::string refusal = Refusal("<mesh filename=\"a.obj\"/>");
  EXPECT_NE(refusal.find("bounding radius [m] = 35.6"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("scale=\"0.001 0.001 0.001\""), std::string::npos) << refusal;
}

TEST_F(PublishedTest, SeveralClosedPiecesAreOneObject) {
  std::string two = "o one\n" + Brick() + "o two\n";
  for (int i = 0; i < 8; ++i)
    two += fmt::format("v {} {} {}\n", 0.024 + 0.012 * ((i & 1) ? 1 : -1),
                       0.015 * ((i & 2) ? 1 : -1), 0.030 * ((i & 4) ? 1 : -1));
  for (const char* face :
       {"9 11 12 10", "13 14 16 15", "9 10 14 13", "11 15 16 12", "9 13 15 11", "10 12 16 14"})
    two += fmt::format("f {}\n", face);
  Write("objects/a.obj", two);  // they touch: the corners between them are shared
  LoadOptions options;
  options.inertia_from_shape = true;
  const ObjectModel object = Object("<mesh filename=\"a.obj\"/>", options, "1");
  EXPECT_LT((Extent(object) - Vector3d(0.048, 0.030, 0.060)).norm(), kSingle);
  // As one box of that size: m / 12 (b² + c²).
  EXPECT_NEAR(object.I_OCom(0, 0), 0.08 / 12 * (0.030 * 0.030 + 0.060 * 0.060), 1e-9);
  EXPECT_NEAR(object.I_OCom(2, 2), 0.08 / 12 * (0.048 * 0.048 + 0.030 * 0.030), 1e-9);
}

TEST_F(PublishedTest, ImpossibleBodiesAreRefusedWithTheReason) {
  const std::string ball = "<sphere radius=\"0.025\"/>";
  EXPECT_EQ(Refusal(ball), "taken");  // a hollow ball has 3.3e-5
  std::string refusal = Refusal(ball, {}, "1e-3");
  for (const char* word :
       {"thing.urdf:1", "0.001", "m R² = 5e-05", "--inertia-from-shape", "--force"})
    EXPECT_NE(refusal.find(word), std::string::npos) << refusal;
  refusal = Refusal("<sphere radius=\"0.003\"/>", {}, "1e-7");
  EXPECT_NE(refusal.find("density of 707355 kg/m³; allowed 10 .. 25000"), std::string::npos)
      << refusal;
  Write("objects/a.obj", Brick());
  refusal = Refusal("<mesh filename=\"a.obj\"/>", {}, "3e-5", "<origin xyz=\"0.2 0 0\"/>");
  EXPECT_NE(refusal.find("outside of the shape, 200 mm"), std::string::npos) << refusal;
  LoadOptions options;
  options.force = true;
  EXPECT_EQ(Refusal(ball, options, "1e-3"), "taken");
  options = {};
  options.inertia_from_shape = true;
  EXPECT_NEAR(Object(ball, options, "1e-3").I_OCom(0, 0), 0.4 * 0.08 * 0.025 * 0.025, 1e-12);
}

TEST_F(PublishedTest, MassPropertiesAgreeByTwoRoutes) {
  // A ball of triangles against the formula of the ball; the polyhedron lies inside by its facets.
  const ObjectModel egg = LoadObject("egg", ModelSearchPath());
  const Solid solid = ObjectSolid(egg);
  EXPECT_LT(solid.centre.norm(), 1e-6);  // the file's centroid is its origin
  EXPECT_LT((solid.inertia * (egg.mass / solid.volume) - egg.I_OCom).norm(),
            1e-3 * egg.I_OCom.norm());
  EXPECT_TRUE(WhyNoBody(egg).empty());
  // A capsule is its tube and its two half balls.
  const Solid capsule = CapsuleSolid(0.01, 0.02);
  EXPECT_NEAR(capsule.volume, M_PI * 1e-4 * 0.04 + 4.0 / 3 * M_PI * 1e-6, 1e-15);
}

TEST_F(PublishedTest, DamagedMeshesEndTheReaderAndNotUs) {
  Write("objects/a.off", "OFF\n4 4 6\n3 -0.03 -0.03 -0.03\n");
  EXPECT_NE(Refusal("<mesh filename=\"a.off\"/>").find("allowed are .obj, .stl, .ply, .dae, .glb"),
            std::string::npos);
  Write(
      "objects/a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0.03 0.03 "
      "0.03\n-0.03 "
      "-0.03 0.03\n-0.03 0.03 -0.03\n0.03 -0.03 -0.03\n3 0 2 1\n3 0 1 3\n3 0 77 2\n3 1 2 3\n");
  EXPECT_NE(Refusal("<mesh filename=\"a.ply\"/>").find("a.ply"), std::string::npos);
}

TEST_F(PublishedTest, TheReadersAnswerIsChecked) {
  const auto message = [](const std::vector<std::uint32_t>& words) {
    try {
      DecodeMesh("m.obj", std::as_bytes(std::span(words)), {});
    } catch (const ModelError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  // magic, text, vertices (64 bit), triangles (64 bit), 3 corners of 1.0, one triangle.
  std::vector<std::uint32_t> good = {0x6d657368, 0, 3, 0, 1, 0};
  for (int i = 0; i < 9; ++i) good.push_back(0x3f800000);
  for (std::uint32_t i = 0; i < 3; ++i) good.push_back(i);
  EXPECT_EQ(message(good), "taken");
  auto bad = good;
  bad.back() = 3;
  EXPECT_NE(message(bad).find("corner 3; there are 3"), std::string::npos);
  bad = good;
  bad[8] = 0x7fc00000;
  EXPECT_NE(message(bad).find("not finite"), std::string::npos);
  bad = good;
  bad[3] = 0xffffffff;
  EXPECT_NE(message(bad).find("allowed are at most"), std::string::npos);
  bad.resize(4);
  EXPECT_NE(message(bad).find("half-way"), std::string::npos);
}

TEST_F(PublishedTest, ShapesAreFittedWithinTheirError) {
  // Points of a capsule of 6 mm radius and 20 mm segment, as a mesh of rings along x.
  RawMesh raw;
  constexpr int kRings = 40, kAround = 24;
  for (int i = 0; i <= kRings; ++i) {
    const double angle = M_PI * i / kRings;
    for (int k = 0; k < kAround; ++k) {
      const double turn = 2 * M_PI * k / kAround;
      const double r = 0.006 * std::sin(angle);
      const double x = -0.006 * std::cos(angle) + (i > kRings / 2 ? 0.02 : 0.0);
      raw.vertices.emplace_back(Vector3d(x, r * std::cos(turn), r * std::sin(turn)).cast<float>());
    }
  }
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kAround; ++k) {
      const int a = i * kAround + k, b = i * kAround + (k + 1) % kAround;
      raw.triangles.emplace_back(a, b, a + kAround);
      raw.triangles.emplace_back(b, b + kAround, a + kAround);
    }
  const TriangleMesh mesh = WeldMesh(raw, Vector3d::Ones());
  // The facets lie up to 6 mm (1 - cos(pi / 24)) = 51 um inside.
  for (const FittedShape& fit : {FitShape(mesh), FitFingertip(mesh, Vector3d::UnitX())}) {
    EXPECT_EQ(fit.kind, "capsule");
    EXPECT_NEAR(fit.shape.radius, 0.006, 6e-5);
    EXPECT_LT(fit.error_m, 1.2e-4);
  }
  const FittedShape tip = FitFingertip(mesh, Vector3d::UnitX());
  EXPECT_LT((tip.shape.b_L - Vector3d(0.02, 0, 0)).norm(), 1e-4);
}

TEST_F(PublishedTest, OtherSuffixesAreNamed) {
  Write("objects/a.sdf", "<sdf/>");
  ExpectRefused({"a.sdf", "must end in .urdf"}, "mini", (root_ / "objects/a.sdf").string());
  fs::rename(root_ / "objects/ball.urdf", root_ / "objects/BALL.URDF");
  EXPECT_EQ(LoadObject((root_ / "objects/BALL.URDF").string(), {}).radius, 0.025);
}

}  // namespace
}  // namespace regrasp
