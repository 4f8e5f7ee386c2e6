/// PLY files as other programs write them, and as none should.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "core/hand/mesh.h"
#include "tests/unit/hand/wild_files.h"

namespace regrasp {
namespace {

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

TEST_F(WildTest, WhatAPlyFileClaimsIsHeldAgainstItsSize) {
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
}

}  // namespace
}  // namespace regrasp
