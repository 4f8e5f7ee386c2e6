/// Files as strangers bring them: each is read as it is meant, or refused with what to do.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/hand/mesh.h"
#include "core/hand/solid.h"
#include "core/hand/urdf.h"
#include "tests/unit/hand/model_files.h"

namespace regrasp {
namespace {

using Corners = std::array<Vector3d, 3>;

/// An L of 20 x 20 mm section, 60 mm long and 40 mm high: concave.
std::vector<Corners> Ell() {
  const Eigen::Vector2d outline[] = {{0, 0}, {60, 0}, {60, 20}, {20, 20}, {20, 40}, {0, 40}};
  const int faces[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  const auto at = [&](int i, double z) {
    return Vector3d(outline[i].x() - 25, outline[i].y() - 15, z - 10);
  };
  std::vector<Corners> triangles;
  for (const auto& f : faces) {
    triangles.push_back({at(f[0], 20), at(f[1], 20), at(f[2], 20)});
    triangles.push_back({at(f[0], 0), at(f[2], 0), at(f[1], 0)});
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    triangles.push_back({at(i, 0), at(j, 0), at(j, 20)});
    triangles.push_back({at(i, 0), at(j, 20), at(i, 20)});
  }
  return triangles;
}
constexpr double kEllVolume = 60 * 20 * 20 + 20 * 20 * 20;  // [mm³]

class WildTest : public LoaderTest {
 protected:
  /// An object of 40 g whose <link> holds `more` beside its mesh.
  ObjectModel Load(const std::string& mesh, const std::string& more = "",
                   const std::string& robot = "") {
    Write(
        "objects/thing.urdf",
        R"(<?xml version="1.0"?><robot xmlns:xacro="http://ros.org/wiki/xacro" name="thing">)" +
            robot +
            R"(<link name="object"><inertial><mass value="0.04"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial>
<collision><geometry>)" +
            mesh + "</geometry></collision>" + more + "</link></robot>");
    LoadOptions options;
    options.inertia_from_shape = true;
    return LoadObject((root_ / "objects/thing.urdf").string(), {}, options);
  }
  std::string Refusal(const std::string& mesh, const std::string& more = "",
                      const std::string& robot = "") {
    try {
      Load(mesh, more, robot);
    } catch (const ModelError& error) {
      return error.what();
    }
    return "taken";
  }
  void ExpectEll(const ObjectModel& object) const {
    EXPECT_EQ(object.triangles.size(), 20u);
    EXPECT_NEAR(ObjectSolid(object).volume, kEllVolume * 1e-9, 1e-6 * kEllVolume * 1e-9);
  }
  static constexpr const char* kMillimetres = R"( scale="0.001 0.001 0.001"/>)";
};

/// A binary STL file of the L, in millimetres. `attributes`: the count of each triangle, and
/// whether as many bytes follow it.
std::string BinaryEll(std::string head = "", std::uint16_t attributes = 0, bool follow = false) {
  head.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(Ell().size());
  head.append(reinterpret_cast<const char*>(&count), 4);
  for (const Corners& corners : Ell()) {
    head.append(12, '\0');
    for (const Vector3d& p : corners) {
      const Eigen::Vector3f single = p.cast<float>();
      head.append(reinterpret_cast<const char*>(single.data()), 12);
    }
    head.append(reinterpret_cast<const char*>(&attributes), 2);
    if (follow) head.append(attributes, '\x7f');
  }
  return head;
}

TEST_F(WildTest, StlInMillimetresOfEitherKind) {
  std::string text = "solid ell\n";
  for (const Corners& corners : Ell()) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const Vector3d& p : corners) text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
    text += "endloop\nendfacet\n";
  }
  Write("objects/text.stl", text + "endsolid ell\n");
  Write("objects/BINARY.STL", BinaryEll());
  for (const char* file : {"text.stl", "BINARY.STL"}) {
    SCOPED_TRACE(file);
    const std::string mesh = fmt::format("<mesh filename=\"{}\"", file);
    const std::string refusal = Refusal(mesh + "/>");
    EXPECT_NE(refusal.find("if the file is in millimetres: <mesh scale=\"0.001 0.001 0.001\">"),
              std::string::npos)
        << refusal;
    ExpectEll(Load(mesh + kMillimetres));
  }
}

// As exporters of robots write them: a header in words, bytes after the last triangle, colours in
// the attribute counts, attributes.
TEST_F(WildTest, BinaryStlWithMoreThanItsTriangles) {
  const struct {
    std::string bytes;
    std::size_t unread;
  } cases[] = {{BinaryEll("solid ell"), 0},
               {BinaryEll() + "\n", 1},
               {BinaryEll("solid ell") + std::string(500, '\0'), 500},
               {BinaryEll("COLOR=", 0x7fff), 0},
               {BinaryEll("", 3, true), 3 * Ell().size()}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.bytes.substr(0, 10) + std::to_string(c.unread));
    Write("objects/more.stl", c.bytes);
    ExpectEll(Load(std::string("<mesh filename=\"more.stl\"") + kMillimetres));
    const TriangleMesh mesh = LoadMesh(root_ / "objects/more.stl", Vector3d::Ones());
    EXPECT_EQ(mesh.unread_bytes, c.unread);
    ModelReport report;
    LoadOptions options;
    options.inertia_from_shape = true;
    (void)LoadObject((root_ / "objects/thing.urdf").string(), {}, options, &report);
    ASSERT_EQ(report.warnings.size(), c.unread > 0 ? 1u : 0u);
    if (c.unread == 0) continue;
    const std::string told =
        fmt::format("more.stl: {} bytes beside its triangles are not read", c.unread);
    EXPECT_NE(report.warnings[0].Line().find(told), std::string::npos) << report.warnings[0].Line();
  }
  std::string many(84, '\0');
  many[82] = 0x10;  // 2^20 triangles
  Write("objects/many.stl", many + std::string(50u << 20, '\0'));
  EXPECT_NE(Refusal("<mesh filename=\"many.stl\"/>")
                .find("1048576 triangles; allowed are at most 333333"),
            std::string::npos);
}

TEST_F(WildTest, ObjWithGroupsAndMaterialsThatAreNotThere) {
  std::string text = "mtllib gone.mtl\n", faces;
  int corner = 0;
  for (const Corners& corners : Ell()) {
    for (const Vector3d& p : corners) text += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    if (corner % 15 == 0) faces += fmt::format("g part{}\nusemtl m{}\n", corner, corner);
    faces += fmt::format("f {} {} {}\n", corner + 1, corner + 2, corner + 3);
    corner += 3;
  }
  Write("objects/groups.obj", text + faces);
  ExpectEll(Load(std::string("<mesh filename=\"groups.obj\"") + kMillimetres));
}

TEST_F(WildTest, PlyWithColours) {
  std::string vertices, faces;
  int corner = 0;
  for (const Corners& corners : Ell()) {
    for (const Vector3d& p : corners)
      vertices += fmt::format("{} {} {} 200 {} 40 255\n", p.x(), p.y(), p.z(), corner);
    faces += fmt::format("3 {} {} {}\n", corner, corner + 1, corner + 2);
    corner += 3;
  }
  std::string head =
      fmt::format("ply\nformat ascii 1.0\ncomment made elsewhere\nelement vertex {}\n", corner);
  for (const char* axis : {"x", "y", "z"}) head += fmt::format("property float {}\n", axis);
  for (const char* colour : {"red", "green", "blue", "alpha"})
    head += fmt::format("property uchar {}\n", colour);
  Write("objects/coloured.ply",
        head +
            fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                        corner / 3) +
            vertices + faces);
  ExpectEll(Load(std::string("<mesh filename=\"coloured.ply\"") + kMillimetres));
}

/// A PLY file of the L, and of what other programs add to it.
std::string Ply(const std::string& format, bool big) {
  std::string text = fmt::format("ply\r\nformat {} 1.0\r\nelement vertex 60\r\n", format);
  for (const char* axis : {"x", "y", "z"}) text += fmt::format("property float {}\r\n", axis);
  text +=
      "property list uint8 int16 marks\r\nelement face 20\r\nproperty uchar flags\r\nproperty list "
      "uchar uint vertex_index\r\nelement edge 1\r\nproperty int a\r\nproperty double b\r\n"
      "end_header\r\n";
  const auto add = [&](auto value) {
    std::array<char, sizeof(value)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(value));
    if (big) std::reverse(bytes.begin(), bytes.end());
    text.append(bytes.data(), bytes.size());
  };
  for (const Corners& corners : Ell())
    for (const Vector3d& p : corners) {
      for (const double c : p) add(static_cast<float>(c));
      add(std::uint8_t{2});
      for (const std::int16_t mark : {-7, 7}) add(mark);
    }
  for (std::uint32_t t = 0; t < 20; ++t) {
    add(std::uint8_t{1});
    add(std::uint8_t{3});
    for (std::uint32_t k = 0; k < 3; ++k) add(3 * t + k);
  }
  add(std::int32_t{1});
  add(2.5);
  return text;
}

TEST_F(WildTest, BinaryPlyOfEitherByteOrderWithPropertiesOfOthers) {
  const std::string mesh = "<mesh filename=\"bytes.ply\"";
  Write("objects/bytes.ply", Ply("binary_little_endian", false));
  ExpectEll(Load(mesh + kMillimetres));
  Write("objects/bytes.ply", Ply("binary_big_endian", true));
  ExpectEll(Load(mesh + kMillimetres));
  const std::string whole = Ply("binary_little_endian", false);
  Write("objects/bytes.ply", whole.substr(0, whole.size() - 20));
  EXPECT_NE(Refusal(mesh + "/>").find("entry 19 of \"face\": the file ends within it"),
            std::string::npos);
}

// The first byte of the first coordinate is that of a line's end.
TEST_F(WildTest, BinaryPlyThatBeginsLikeALine) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
  const float corners[] = {-0.02F, -0.02F, -0.02F, 0.02F,  -0.02F, -0.02F,
                           -0.02F, 0.02F,  -0.02F, -0.02F, -0.02F, 0.02F};
  ASSERT_EQ(std::memcmp(corners, "\n", 1), 0);
  text.append(reinterpret_cast<const char*>(corners), sizeof(corners));
  for (const auto& face : {Eigen::Vector3i(0, 2, 1), Eigen::Vector3i(0, 1, 3),
                           Eigen::Vector3i(0, 3, 2), Eigen::Vector3i(1, 2, 3)}) {
    text += '\3';
    text.append(reinterpret_cast<const char*>(face.data()), 12);
  }
  Write("objects/line.ply", text);
  EXPECT_NEAR(ObjectSolid(Load("<mesh filename=\"line.ply\"/>")).volume, 0.064e-3 / 6, 1e-10);
}

TEST_F(WildTest, WhatAMeshFileClaimsIsHeldAgainstItsSize) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string body = "0 0 0\n.03 0 0\n0 .03 0\n0 0 .03\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const auto refusal = [&](const std::string& text) {
    Write("objects/claims.ply", text);
    return Refusal("<mesh filename=\"claims.ply\"/>");
  };
  EXPECT_EQ(refusal(header + body), "taken");
  const struct {
    const char *from, *to, *word;
  } cases[] = {
      {"vertex 4", "vertex 10000000", "claims 10000000 entries of \"vertex\"; allowed are at most"},
      {"vertex 4", "vertex 90000", "540000 bytes at least; after it stand 62"},
      {"face 4", "face -4", "has the count \"-4\""},
      {"face 4", "face 5", "entry 4 of \"face\": the file ends within it"},
      {"end_header\n", "", "no end_header"},
      {"ascii", "text", "the format \"text\" is unknown"},
      {"float z", "half z", "type \"half\" is unknown"},
      {"element face", "element faces", "no element \"face\""},
      {".03 0 0", "0,03 0 0", "entry 1 of \"vertex\": \"0,03\" is no number"},
      {".03 0 0", "nan 0 0", "entry 1 of \"vertex\": x, y and z must be finite"},
      {"3 1 2 3", "3 1 2 4", "triangle 3 has the corner 4; there are 4 vertices"},
      {"3 1 2 3", "-3 1 2 3", "entry 3 of \"face\": a list of -3 values"},
      {"ply\n", "plx\n", "must be \"ply\""},
  };
  for (const auto& c : cases)
    EXPECT_NE(refusal(Replaced(header + body, c.from, c.to)).find(c.word), std::string::npos)
        << refusal(Replaced(header + body, c.from, c.to));
  // An STL file's count.
  std::string stl(84, '\0');
  stl[80] = 12;
  Write("objects/claims.stl", stl + std::string(550, '\0'));
  EXPECT_NE(Refusal("<mesh filename=\"claims.stl\"/>")
                .find("a binary STL file of 12 triangles has 684 bytes; this one has 634"),
            std::string::npos);
}

TEST_F(WildTest, AMeshInCentimetresIsToldSo) {
  std::string text, faces;
  int corner = 0;
  for (const Corners& corners : Ell())
    for (const Vector3d& p : corners) {
      text += fmt::format("v {} {} {}\n", p.x() / 10, p.y() / 10, p.z() / 10);
      faces += fmt::format("{}{}", corner % 3 == 0 ? "\nf " : " ", corner + 1);
      ++corner;
    }
  Write("objects/cm.obj", text + faces + "\n");
  const std::string refusal = Refusal("<mesh filename=\"cm.obj\"/>");
  const std::string scale = "scale=\"0.01 0.01 0.01\"";
  EXPECT_NE(refusal.find("if the file is in centimetres: <mesh " + scale + ">"), std::string::npos)
      << refusal;
  ExpectEll(Load("<mesh filename=\"cm.obj\" " + scale + "/>"));
}

TEST_F(WildTest, AMirroredNodeOfACollada) {
  std::string points, indices;
  int corner = 0;
  for (const Corners& corners : Ell())
    for (const Vector3d& p : corners) {
      points += fmt::format("{} {} {} ", p.x() / 1000, p.y() / 1000, p.z() / 1000);
      indices += fmt::format("{} ", corner++);
    }
  for (const char* scale : {"1 1 1", "-1 1 1"}) {
    Write(
        "objects/node.dae",
        fmt::format(
            R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="180">{}</float_array><technique_common><accessor source="#a" count="60" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="20"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node id="n">
<scale>{}</scale><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)",
            points, indices, scale));
    ExpectEll(Load("<mesh filename=\"node.dae\"/>"));
  }
}

// A frame above the object, a lid and a weight, all fixed: 30 g in the middle, 10 g 40 mm away.
TEST_F(WildTest, LinksThatAreFixedToEachOtherAreOneBody) {
  const auto fixed = [](const char* parent, const char* child, const char* xyz) {
    return fmt::format(
        R"(<joint name="to_{1}" type="fixed"><parent link="{0}"/><child link="{1}"/><origin xyz="{2}"/></joint>)",
        parent, child, xyz);
  };
  Write("objects/parts.urdf",
        R"(<robot name="parts"><link name="world"/><link name="body"><inertial><mass value="0.03"/>
<inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial>
<collision><geometry><box size="0.04 0.04 0.04"/></geometry></collision></link><link name="lid">
<inertial><mass value="0.01"/><inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial>
<inertial><mass value="7"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
<collision><origin xyz="0 0 0.01"/><geometry><box size="0.04 0.04 0.02"/></geometry></collision></link>)" +
            fixed("world", "body", "0.5 0 0") + fixed("body", "lid", "0 0 0.02") + "</robot>");
  ModelReport report;
  const ObjectModel object = LoadObject((root_ / "objects/parts.urdf").string(), {}, {}, &report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(
      report.warnings[0].Line().find("parts.urdf:5: link \"lid\": a second <inertial> is not read"),
      std::string::npos)
      << report.warnings[0].Line();
  EXPECT_DOUBLE_EQ(object.mass, 0.04);
  EXPECT_NEAR(ObjectSolid(object).volume, 0.04 * 0.04 * 0.06, 1e-9);
  // About the common centre, 5 mm above the body's.
  EXPECT_NEAR(object.I_OCom(0, 0), 1.1e-5 + 0.03 * 0.005 * 0.005 + 0.01 * 0.015 * 0.015, 1e-12);
  EXPECT_NEAR(object.I_OCom(2, 2), 1.1e-5, 1e-12);
  EXPECT_NEAR(ObjectSolid(object).centre.z(), 0.01 - 0.005, 1e-6);
}

TEST_F(WildTest, OfTwoInertialsTheFirstCountsAndTheOtherIsTold) {
  const LoadedScenario once = LoaderTest::Load();
  EditHand("<mass value=\"0.01\"/><inertia",
           "<mass value=\"0.01\"/><inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\" iyz=\"0\" "
           "izz=\"1e-6\"/></inertial><inertial><mass value=\"0.5\"/><inertia");
  const LoadedScenario twice = LoaderTest::Load();
  EXPECT_EQ(twice.hand.links[2].mass, once.hand.links[2].mass);
  ASSERT_EQ(twice.report.warnings.size(), once.report.warnings.size() + 1);
  EXPECT_TRUE(std::ranges::any_of(twice.report.warnings, [](const ModelWarning& warning) {
    return warning.Line().find("mini.urdf:9: link \"tip\": a second <inertial> is not read") !=
           std::string::npos;
  }));
  EditHand("<mass value=\"0.01\"/><inertia",
           "<mass value=\"0.01\"/><inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\" iyz=\"0\" "
           "izz=\"1e-6\"/></inertial><inertial><mass value=\"0,5\"/><inertia");
  ExpectRefused({"mini.urdf:9", "link \"tip\"", "\"0,5\"", "finite number"});
}

TEST_F(WildTest, AMomentAboveThatOfALinksSizeIsTold) {
  const auto told = [](const LoadedScenario& loaded) {
    return std::ranges::any_of(loaded.report.warnings, [](const ModelWarning& warning) {
      return warning.Line().find(
                 "mini.urdf:9: link \"tip\": <inertia> has the moment 0.0002 kg m²; "
                 "a body of its size has at most m R² = ") != std::string::npos;
    });
  };
  EXPECT_FALSE(told(LoaderTest::Load()));
  EditHand("<inertia ixx=\"2e-6\" ixy=\"0\" ixz=\"0\" iyy=\"2e-6\"",
           "<inertia ixx=\"2e-4\" ixy=\"0\" ixz=\"0\" iyy=\"2e-4\"");
  EXPECT_TRUE(told(LoaderTest::Load()));
}

// Published with a slip of the decimal point: the centre of a finger of 50 mm 300 mm away.
TEST_F(WildTest, ACentreOfMassFarOutsideALinkIsRefusedAndComputedWhenAsked) {
  EditHand("<origin xyz=\"0 0 0.02\"/>", "<origin xyz=\"-0.29 0.001 0.17\"/>");
  ExpectRefused({"mini.urdf:5", "link \"upper\"", "centre of mass (-0.29, 0.001, 0.17) m",
                 "mm outside its shapes", "--inertia-from-shape"});
  LoadOptions options;
  options.inertia_from_shape = true;
  const LoadedScenario computed = LoadScenario("mini", "", {root_}, options);
  EXPECT_LT(computed.hand.links[1].p_LCom.norm(), 1e-9);
  EXPECT_DOUBLE_EQ(computed.hand.links[1].mass, 0.03);
  // Somewhat outside is common: motors and plates without a shape.
  EditHand("<origin xyz=\"0 0 0.02\"/>", "<origin xyz=\"0 0 0.05\"/>");
  EXPECT_EQ(LoaderTest::Load().hand.links[1].p_LCom, Vector3d(0, 0, 0.05));
}

TEST_F(WildTest, PathsOfOtherSystems) {
  std::string text, faces;
  int corner = 0;
  for (const Corners& corners : Ell()) {
    for (const Vector3d& p : corners)
      text += fmt::format("v {} {} {}\n", p.x() / 1e3, p.y() / 1e3, p.z() / 1e3);
    faces += fmt::format("f {} {} {}\n", corner + 1, corner + 2, corner + 3);
    corner += 3;
  }
  fs::create_directories(root_ / "objects/meshes");
  Write("objects/meshes/ell.obj", text + faces);
  const std::string root = fs::absolute(root_).string();
  for (const std::string& path :
       {std::string("meshes/ell.obj"), std::string("./meshes/../meshes/ell.obj"),
        std::string("meshes\\ell.obj"), std::string("package://objects/meshes/ell.obj"),
        std::string("model://objects/meshes/ell.obj"), "file://" + root + "/objects/meshes/ell.obj",
        root + "/objects/meshes/ell.obj"}) {
    SCOPED_TRACE(path);
    ExpectEll(Load(fmt::format("<mesh filename=\"{}\"/>", path)));
  }
  const fs::path elsewhere = root_ / "elsewhere/ell_description/meshes";
  fs::create_directories(elsewhere);
  fs::copy(root_ / "objects/meshes/ell.obj", elsewhere);
  const std::string mesh = "<mesh filename=\"model://ell_description/meshes/ell.obj\"/>";
  EXPECT_NE(Refusal(mesh).find("$GAZEBO_MODEL_PATH"), std::string::npos) << Refusal(mesh);
  ::setenv("GAZEBO_MODEL_PATH", ("/nowhere:" + root + "/elsewhere").c_str(), 1);
  ExpectEll(Load(mesh));
  ::unsetenv("GAZEBO_MODEL_PATH");
}

TEST_F(WildTest, WhatOtherProgramsAddIsPassedOver) {
  const std::string sphere = "<sphere radius=\"0.02\"/>";
  EXPECT_EQ(Load(sphere,
                 R"(<contact><lateral_friction value="x"/>g</contact><self_collide>1</self_collide>
<visual><geometry><xacro:shape/><mesh filename="${gone}"/></geometry><material name="red"/></visual>)",
                 R"(<material name="red"><color rgba="1 0 0"/></material>
<gazebo reference="object"><mu1>${mu}</mu1></gazebo><gazebo><plugin name="p" filename="lib.so"/></gazebo>
<transmission name="t"><type>x</type></transmission>)")
                .radius,
            0.02);
}

TEST_F(WildTest, XacroThatHasNotBeenRunIsNamed) {
  const std::string sphere = "<sphere radius=\"0.02\"/>";
  std::string refusal = Refusal(sphere, "", "<xacro:property name=\"r\" value=\"1\"/>");
  EXPECT_NE(refusal.find("thing.urdf:1: <xacro:property> in <robot>"), std::string::npos)
      << refusal;
  EXPECT_NE(refusal.find("run xacro over the file first"), std::string::npos) << refusal;
  refusal = Refusal(sphere, "<xacro:ball_inertia m=\"1\"/>");
  EXPECT_NE(refusal.find("<xacro:ball_inertia> in <link>"), std::string::npos) << refusal;
  refusal = Refusal("<sphere radius=\"${r}\"/>");
  EXPECT_NE(refusal.find("run xacro"), std::string::npos) << refusal;
}

TEST_F(WildTest, FilesOfOtherKindsAreNamed) {
  const auto refusal = [&](const std::string& name) {
    Write(name, "");
    try {
      LoadObject((root_ / name).string(), {});
    } catch (const ModelError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(refusal("objects/a.urdf.xacro").find("xacro FILE.xacro -o FILE.urdf"),
            std::string::npos);
  EXPECT_NE(refusal("objects/a.STL").find("a mesh needs one that names it"), std::string::npos);
  EXPECT_NE(refusal("objects/a.sdf").find("SDF, MJCF and USD are not read"), std::string::npos);
}

}  // namespace
}  // namespace regrasp
