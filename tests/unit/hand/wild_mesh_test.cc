/// Meshes as strangers bring them: each is read as it is meant, or refused with what to do.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "core/hand/mesh.h"
#include "tests/unit/hand/wild_files.h"

namespace regrasp {
namespace {

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
  text += "endsolid ell\n";
  Write("objects/text.stl", text);
  Write("objects/bom.stl", "\xEF\xBB\xBF" + text);
  const std::string small = text;
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  Write("objects/CAPITALS.STL", text);
  Write("objects/blank.stl", "\r\n \t\n" + text);
  Write("objects/both.stl", "\xEF\xBB\xBF" + std::string(200, '\n') + "S" + small.substr(1));
  Write("objects/BINARY.STL", BinaryEll());
  for (const char* file :
       {"text.stl", "bom.stl", "blank.stl", "both.stl", "CAPITALS.STL", "BINARY.STL"}) {
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

TEST_F(WildTest, AnStlFilesCountIsHeldAgainstItsSize) {
  std::string stl(84, '\0');
  stl[80] = 12;
  Write("objects/claims.stl", stl + std::string(550, '\0'));
  EXPECT_NE(Refusal("<mesh filename=\"claims.stl\"/>")
                .find("a binary STL file of 12 triangles has 684 bytes; this one has 634"),
            std::string::npos);
}

/// The L as Wavefront text; lengths in `unit` [m].
std::string EllIn(double unit) {
  std::string text, faces;
  int corner = 0;
  for (const Corners& corners : Ell())
    for (const Vector3d& p : corners) {
      const Vector3d v = p * 1e-3 / unit;
      text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
      faces += fmt::format("{}{}", corner % 3 == 0 ? "\nf " : " ", corner + 1);
      ++corner;
    }
  return text + faces + "\n";
}

TEST_F(WildTest, UnitsInWhichAMeshWouldBePlausibleAreNamed) {
  const std::string mm = " in millimetres: <mesh scale=\"0.001 0.001 0.001\">",
                    cm = " in centimetres: <mesh scale=\"0.01 0.01 0.01\">",
                    inch = " in inches: <mesh scale=\"0.0254 0.0254 0.0254\">",
                    begin = "; if the file is";
  Write("objects/mm.obj", EllIn(1e-3));
  Write("objects/cm.obj", EllIn(1e-2));
  Write("objects/inch.obj", EllIn(0.0254));
  for (const auto& [file, hint] :
       {std::pair{"mm", begin + mm}, std::pair{"cm", begin + cm + "," + inch},
        std::pair{"inch", begin + cm + "," + inch}}) {
    const std::string refusal = Refusal(fmt::format("<mesh filename=\"{}.obj\"/>", file));
    EXPECT_TRUE(refusal.ends_with(hint)) << refusal;
  }
  ExpectEll(Load("<mesh filename=\"cm.obj\" scale=\"0.01 0.01 0.01\"/>"));
  ExpectEll(Load("<mesh filename=\"inch.obj\" scale=\"0.0254 0.0254 0.0254\"/>"));
  EditHand("<box size=\"0.01 0.01 0.04\"/>", "<mesh filename=\"../objects/inch.obj\"/>");
  ExpectRefused({"the mesh is 2.362 m long; allowed are at most 1 m; if the file is in centimetres",
                 inch.c_str()});
}

TEST_F(WildTest, OfALongMeshPathTheEndIsTold) {
  const std::string path =
      "package://a_hand_description/" + std::string(60, 'm') + "/collision/the_fingertip.stl";
  EditHand("<box size=\"0.01 0.01 0.04\"/>", "<mesh filename=\"" + path + "\"/>");
  ExpectRefused({"mm/collision/the_fingertip.stl\": file not found"});
}

TEST_F(WildTest, WhatGitLeavesOfAMeshThatWasNotFetchedIsNamed) {
  for (const char* suffix : {".obj", ".stl", ".ply", ".dae", ".glb"}) {
    Write(std::string("objects/lfs") + suffix,
          "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 12345\n");
    const std::string refusal = Refusal(fmt::format("<mesh filename=\"lfs{}\"/>", suffix));
    EXPECT_TRUE(refusal.ends_with(
        fmt::format("lfs{}: a Git LFS pointer, not the mesh; run git lfs pull", suffix)))
        << refusal;
  }
}

}  // namespace
}  // namespace regrasp
