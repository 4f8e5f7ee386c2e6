#include "core/hand/stl_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "core/hand/mesh_text.h"

namespace regrasp {
namespace {

static_assert(std::endian::native == std::endian::little, "as the numbers of the file");

constexpr std::size_t kHead = 84, kTriangle = 50;  // [bytes]: a count at 80; normal, corners, count

std::uint32_t Claimed(std::string_view head) {
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, head.data() + kHead - sizeof(triangles), sizeof(triangles));
  return triangles;
}

std::size_t AttributeBytes(std::string_view triangle) {
  std::uint16_t bytes = 0;
  std::memcpy(&bytes, triangle.data() + kTriangle - sizeof(bytes), sizeof(bytes));
  return bytes;
}

/// Whether attributes stand between the triangles: then they end where the file does.
bool HasAttributes(std::string_view bytes, std::size_t triangles) {
  std::size_t at = kHead;
  for (std::size_t i = 0; i < triangles; ++i) {
    if (at + kTriangle > bytes.size()) return false;
    at += kTriangle + AttributeBytes(bytes.substr(at));
  }
  return at == bytes.size();
}

/// Behind a byte order mark, blank lines or not.
bool BeginsAsText(std::istream* in) {
  in->clear();
  in->seekg(0);
  SkipByteOrderMark(in);
  return SkipToSolid(in);
}

}  // namespace

std::optional<std::uint64_t> BinaryStlRest(const std::filesystem::path& file, std::uint64_t size) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw ModelError(std::strerror(errno));
  std::string head(kHead, '\0');
  in.read(head.data(), kHead);
  const bool whole = size >= kHead && in.gcount() == static_cast<std::streamsize>(kHead);
  const std::uint64_t wanted = kHead + kTriangle * std::uint64_t{Claimed(head)};
  if (whole && size >= wanted) return size - wanted;
  if (BeginsAsText(&in)) return std::nullopt;
  if (!whole)
    throw ModelError(
        fmt::format("{} bytes that do not begin with \"solid\" are no STL file", size));
  throw ModelError(fmt::format("a binary STL file of {} triangles has {} bytes; this one has {}",
                               Claimed(head), wanted, size));
}

RawMesh ReadBinaryStl(const std::filesystem::path& file, const MeshLimits& limits) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw ModelError(std::strerror(errno));
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  const std::size_t triangles = bytes.size() < kHead ? 0 : Claimed(bytes);
  const std::size_t most = std::min(limits.triangles, limits.vertices / 3);
  if (triangles > most)
    throw ModelError(fmt::format("{} triangles; allowed are at most {}", triangles, most));
  if (bytes.size() < kHead + kTriangle * triangles) throw ModelError("the file has become shorter");
  const bool attributes = HasAttributes(bytes, triangles);
  RawMesh mesh;
  std::size_t at = kHead;
  for (std::size_t i = 0; i < triangles; ++i) {
    const std::string_view triangle = std::string_view(bytes).substr(at, kTriangle);
    for (std::size_t k = 1; k <= 3; ++k) {  // after the normal
      Eigen::Vector3f v;
      std::memcpy(v.data(), triangle.data() + k * sizeof(v), sizeof(v));
      mesh.vertices.push_back(v);
    }
    mesh.triangles.push_back(static_cast<int>(3 * i) + Eigen::Vector3i(0, 1, 2).array());
    at += kTriangle + (attributes ? AttributeBytes(triangle) : 0);
  }
  return mesh;
}

}  // namespace regrasp
