#include "core/hand/ply_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "core/hand/ply_header.h"
#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

/// The entries after the header.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const MeshLimits& limits) : limits_(limits) {
    std::ifstream in(file, std::ios::binary);
    if (!in) Fail(std::strerror(errno));
    text_.assign(std::istreambuf_iterator<char>(in), {});
  }

  PolygonMesh Read() {
    header_ = ReadPlyHeader(text_, limits_);
    at_ = header_.bytes;
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;  // nothing stands there, however many
      element_ = &element;
      for (entry_ = 0; entry_ < element.count; ++entry_) {
        if (element.name == "vertex")
          ReadVertex();
        else
          ReadEntry(element.name == "face");
      }
    }
    CheckCorners();
    return std::move(read_);
  }

 private:
  [[noreturn]] void Fail(const std::string& why) const { throw ModelError(why); }
  [[noreturn]] void FailHere(const std::string& why) const {
    Fail(fmt::format("entry {} of {}: {}", entry_, Quoted(element_->name), why));
  }

  double Next(const PlyType& type) {
    if (header_.format == PlyHeader::Format::kAscii) return NextWord();
    const auto n = static_cast<std::size_t>(type.bytes);
    if (text_.size() - at_ < n) FailHere("the file ends within it");
    std::array<char, 8> bytes{};
    std::copy_n(text_.data() + at_, n, bytes.data());
    at_ += n;
    if ((header_.format == PlyHeader::Format::kLittle) !=
        (std::endian::native == std::endian::little))
      std::reverse(bytes.begin(), bytes.begin() + type.bytes);
    const auto as = [&](auto value) {
      std::memcpy(&value, bytes.data(), sizeof(value));
      return static_cast<double>(value);
    };
    if (type.kind == 'f') return type.bytes == 4 ? as(float{}) : as(double{});
    if (type.bytes == 1) return type.kind == 'i' ? as(std::int8_t{}) : as(std::uint8_t{});
    if (type.bytes == 2) return type.kind == 'i' ? as(std::int16_t{}) : as(std::uint16_t{});
    return type.kind == 'i' ? as(std::int32_t{}) : as(std::uint32_t{});
  }

  double NextWord() {
    constexpr std::string_view kSpace = " \t\r\n";
    const std::size_t begin = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
    const std::size_t end = std::min(text_.find_first_of(kSpace, begin), text_.size());
    if (begin == end) FailHere("the file ends within it");
    std::string_view word(text_.data() + begin, end - begin);
    at_ = end;
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size())
      FailHere(fmt::format("{} is no number", Quoted(std::string(word))));
    return value;
  }

  /// The length of a list, which cannot be longer than what is left of the file.
  std::size_t Length(const PlyProperty& property) {
    const double length = Next(*property.length);
    if (!(length >= 0 && length <= static_cast<double>(text_.size())) ||
        length != std::floor(length))
      FailHere(fmt::format("a list of {:g} values", length));
    return static_cast<std::size_t>(length);
  }

  void ReadVertex() {
    Eigen::Vector3f v = Eigen::Vector3f::Constant(NAN);
    for (const PlyProperty& property : element_->properties) {
      std::size_t values = property.length ? Length(property) : 1;
      for (; values > 0; --values) {
        const double value = Next(*property.type);
        for (int k = 0; k < 3; ++k)
          if (property.name == std::string_view(&"xyz"[k], 1)) v[k] = static_cast<float>(value);
      }
    }
    if (!v.allFinite()) FailHere("x, y and z must be finite numbers");
    read_.mesh.vertices.push_back(v);
  }

  void ReadEntry(bool face) {
    for (const PlyProperty& property : element_->properties) {
      const bool is_corners =
          face && property.length &&
          (property.name == "vertex_indices" || property.name == "vertex_index");
      const std::size_t values = property.length ? Length(property) : 1;
      corners_.clear();
      for (std::size_t k = 0; k < values; ++k) {
        const double value = Next(*property.type);
        if (!is_corners) continue;
        if (!(value >= 0 && value <= 2e9) || value != std::floor(value))
          FailHere(fmt::format("the corner {:g}; must be the number of a vertex", value));
        corners_.push_back(static_cast<int>(value));
        if (read_.triangles + corners_.size() > limits_.triangles + 2)
          Fail(fmt::format("more than {} triangles", limits_.triangles));
      }
      if (corners_.size() < 3) continue;  // points and lines enclose nothing
      read_.triangles += corners_.size() - 2;
      if (corners_.size() == 3)
        read_.mesh.triangles.emplace_back(corners_[0], corners_[1], corners_[2]);
      else
        read_.polygons.push_back(corners_);
    }
  }

  /// Their vertices can stand after them in the file.
  void CheckCorners() const {
    if (read_.polygons.empty()) return;
    const std::size_t vertices = read_.mesh.vertices.size();
    const auto check = [&](const auto& corners, std::size_t number) {
      for (const int corner : corners)
        if (static_cast<std::size_t>(corner) >= vertices)
          Fail(fmt::format("a face of {} corners has the corner {}; there are {} vertices", number,
                           corner, vertices));
    };
    for (const std::vector<int>& polygon : read_.polygons) check(polygon, polygon.size());
    for (const Eigen::Vector3i& triangle : read_.mesh.triangles) check(triangle, 3);
  }

  const MeshLimits& limits_;
  std::string text_;
  std::size_t at_ = 0;
  PlyHeader header_;
  const PlyElement* element_ = nullptr;  // that is read
  std::uint64_t entry_ = 0;
  PolygonMesh read_;
  std::vector<int> corners_;  // of the list that is read
};

}  // namespace

PolygonMesh ReadPly(const std::filesystem::path& file, const MeshLimits& limits) {
  return Reader(file, limits).Read();
}

std::string ObjText(const PolygonMesh& mesh) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const Eigen::Vector3f& v : mesh.mesh.vertices)
    fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  const auto add = [&](const auto& corners) {
    text += 'f';
    for (const int corner : corners) fmt::format_to(out, " {}", std::int64_t{corner} + 1);
    text += '\n';
  };
  for (const Eigen::Vector3i& triangle : mesh.mesh.triangles) add(triangle);
  for (const std::vector<int>& polygon : mesh.polygons) add(polygon);
  return text;
}

RawMesh Fans(PolygonMesh mesh) {
  for (const std::vector<int>& polygon : mesh.polygons)
    for (std::size_t k = 2; k < polygon.size(); ++k)
      mesh.mesh.triangles.emplace_back(polygon[0], polygon[k - 1], polygon[k]);
  return std::move(mesh.mesh);
}

}  // namespace regrasp
