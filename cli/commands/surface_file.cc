#include "cli/commands/surface_file.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace regrasp::cli {
namespace {

using Point = std::array<double, 3>;
using Triangle = std::array<std::size_t, 3>;

void AddFloats(std::string* bytes, const Point& p) {
  for (double x : p) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(x));
    for (int i = 0; i < 4; ++i) *bytes += static_cast<char>(bits >> (8 * i));  // little endian
  }
}

/// Twice its area times its normal.
Point NormalOf(const Point& a, const Point& b, const Point& c) {
  const Point u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

}  // namespace

std::string PlyText(const Json& mesh) {
  const auto vertices = mesh.at("vertices_O_m").get<std::vector<Point>>();
  const auto normals = mesh.at("normals_O").get<std::vector<Point>>();
  const auto unknown = mesh.at("unknown_rad").get<std::vector<double>>();
  const auto errors = mesh.at("error_m").get<std::vector<double>>();
  const auto triangles = mesh.at("triangles").get<std::vector<Triangle>>();
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment surface as felt, in the object's frame, metres\n"
      "element vertex {}\n",
      vertices.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "unknown_rad", "error_m"})
    text += fmt::format("property float {}\n", name);
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                      triangles.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Point &p = vertices[i], &n = normals.at(i);
    text += fmt::format("{:.9g} {:.9g} {:.9g} {:.6f} {:.6f} {:.6f} {:.5f} {:.3e}\n", p[0], p[1],
                        p[2], n[0], n[1], n[2], unknown.at(i), errors.at(i));
  }
  for (const Triangle& t : triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string StlText(const Json& mesh) {
  const auto vertices = mesh.at("vertices_O_m").get<std::vector<Point>>();
  const auto triangles = mesh.at("triangles").get<std::vector<Triangle>>();
  std::string bytes = "surface as felt, in the object's frame, metres";
  bytes.resize(80, ' ');
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(triangles.size() >> (8 * i));
  for (const Triangle& t : triangles) {
    const Point &a = vertices.at(t[0]), &b = vertices.at(t[1]), &c = vertices.at(t[2]);
    Point n = NormalOf(a, b, c);
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& x : n) x = length > 0 ? x / length : 0;
    for (const Point& p : {n, a, b, c}) AddFloats(&bytes, p);
    bytes += std::string(2, '\0');
  }
  return bytes;
}

}  // namespace regrasp::cli
