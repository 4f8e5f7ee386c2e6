/// Files as strangers bring them: each is read as it is meant, or refused with what to do.

#include <fmt/format.h>
#include <gtest/gtest.h>

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

TEST_F(WildTest, StlInMillimetresOfEitherKind) {
  std::string text = "solid ell\n";
  std::string binary(80, ' ');
  const auto count = static_cast<std::uint32_t>(Ell().size());
  binary.append(reinterpret_cast<const char*>(&count), 4);
  for (const Corners& corners : Ell()) {
    text += "facet normal 0 0 0\nouter loop\n";
    binary.append(12, '\0');
    for (const Vector3d& p : corners) {
      text += fmt::format("vertex {} {} {}\n", p.x(), p.y(), p.z());
      const Eigen::Vector3f single = p.cast<float>();
      binary.append(reinterpret_cast<const char*>(single.data()), 12);
    }
    text += "endloop\nendfacet\n";
    binary.append(2, '\0');
  }
  Write("objects/text.stl", text + "endsolid ell\n");
  Write("objects/BINARY.STL", binary);
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
