/// Meshes as strangers bring them: each is read as it is meant, or refused with what to do.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
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
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  Write("objects/CAPITALS.STL", text);
  Write("objects/BINARY.STL", BinaryEll());
  for (const char* file : {"text.stl", "bom.stl", "CAPITALS.STL", "BINARY.STL"}) {
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
  const std::string text =
      head +
      fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                  corner / 3) +
      vertices + faces;
  for (const char* begin : {"", "\xEF\xBB\xBF"}) {
    Write("objects/coloured.ply", begin + text);
    ExpectEll(Load(std::string("<mesh filename=\"coloured.ply\"") + kMillimetres));
  }
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

double Area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

/// A prism of 20 mm on an outline [mm], counter-clockwise, that begins at its corner `first`. Its
/// faces stand before its vertices.
std::string PolygonPrism(const std::vector<std::array<int, 2>>& outline, std::size_t first) {
  const std::size_t n = outline.size();
  std::string vertices, faces, low = fmt::format("{}", n), high = low;
  for (std::size_t i = 0; i < n; ++i) {
    const auto [x, y] = outline[(first + i) % n];
    vertices += fmt::format("{} {} 0\n{} {} 20\n", x, y, x, y);
    const std::size_t j = (i + 1) % n;
    faces += fmt::format("4 {} {} {} {}\n", 2 * i, 2 * j, 2 * j + 1, 2 * i + 1);
    high += fmt::format(" {}", 2 * i + 1);
    low += fmt::format(" {}", 2 * (n - 1 - i));
  }
  return fmt::format(
             "ply\nformat ascii 1.0\nelement face {}\nproperty list uchar int vertex_indices\n"
             "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
             "end_header\n",
             n + 2, 2 * n) +
         faces + low + "\n" + high + "\n" + vertices;
}

// A fan from one corner of a concave polygon has the same signed area, but folds over itself.
TEST_F(WildTest, PlyWithConcavePolygons) {
  const struct {
    std::vector<std::array<int, 2>> outline;
    double area, around;  // [mm²], [mm]
  } cases[] = {
      {{{0, 0}, {40, 0}, {40, 10}, {10, 10}, {10, 40}, {0, 40}}, 700, 160},
      {{{0, 0}, {30, 0}, {10, 10}, {0, 30}}, 300, 60 + 2 * std::sqrt(500.0)},
  };
  for (const auto& c : cases)
    for (std::size_t first = 0; first < c.outline.size(); ++first) {
      SCOPED_TRACE(fmt::format("{} corners from {}", c.outline.size(), first));
      Write("objects/prism.ply", PolygonPrism(c.outline, first));
      const auto solid =
          ObjectSolid(Load(std::string("<mesh filename=\"prism.ply\"") + kMillimetres));
      EXPECT_NEAR(solid.volume, c.area * 20e-9, 1e-9);
      EXPECT_NEAR(Area(LoadMesh(root_ / "objects/prism.ply", Vector3d::Constant(1e-3))),
                  (2 * c.area + 20 * c.around) * 1e-6, 1e-9);
    }
}

TEST_F(WildTest, PlyWithPolygonsThatCannotBe) {
  const auto file = [](int vertices, const std::string& faces, int number) {
    return fmt::format(
               "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
               "property float z\nelement face {}\nproperty list uchar int vertex_indices\n"
               "end_header\n",
               vertices, number) +
           "0 0 0\n.03 0 0\n0 .03 0\n0 0 .03\n" + faces;
  };
  const std::string mesh = "<mesh filename=\"some.ply\"/>";
  const std::string rest = "3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  Write("objects/some.ply", file(4, "4 0 2 1 4\n" + rest, 4));
  EXPECT_NE(Refusal(mesh).find("a face of 4 corners has the corner 4; there are 4 vertices"),
            std::string::npos);
  Write("objects/some.ply", file(4, "4 0 2 1 0\n3 0 1 7\n3 0 3 2\n3 1 2 3\n", 4));
  EXPECT_NE(Refusal(mesh).find("a face of 3 corners has the corner 7; there are 4 vertices"),
            std::string::npos);
  // With a corner twice, as some exporters write triangles.
  for (const char* bottom : {"4 0 2 1 1\n", "4 0 0 2 1\n", "5 0 2 1 1 1\n", "6 0 2 2 1 1 0\n"}) {
    SCOPED_TRACE(bottom);
    Write("objects/some.ply", file(4, bottom + rest, 4));
    EXPECT_NEAR(ObjectSolid(Load(mesh)).volume, 0.027e-3 / 6, 1e-10);
  }
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

}  // namespace
}  // namespace regrasp
