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
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

struct Type {
  std::string_view name, other_name;
  int bytes;
  char kind;  // of a number: i, u, f
};
constexpr Type kTypes[] = {{"char", "int8", 1, 'i'},     {"uchar", "uint8", 1, 'u'},
                           {"short", "int16", 2, 'i'},   {"ushort", "uint16", 2, 'u'},
                           {"int", "int32", 4, 'i'},     {"uint", "uint32", 4, 'u'},
                           {"float", "float32", 4, 'f'}, {"double", "float64", 8, 'f'}};

struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* length = nullptr;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { kAscii, kLittle, kBig };

class Reader {
 public:
  Reader(const std::filesystem::path& file, const MeshLimits& limits) : limits_(limits) {
    std::ifstream in(file, std::ios::binary);
    if (!in) Fail(std::strerror(errno));
    text_.assign(std::istreambuf_iterator<char>(in), {});
  }

  RawMesh Read() {
    ReadHeader();
    CheckCounts();
    for (const Element& element : elements_) {
      if (element.properties.empty()) continue;  // nothing stands there, however many
      element_ = &element;
      for (entry_ = 0; entry_ < element.count; ++entry_) {
        if (element.name == "vertex")
          ReadVertex();
        else
          ReadEntry(element.name == "face");
      }
    }
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void Fail(const std::string& why) const { throw ModelError(why); }
  [[noreturn]] void FailHere(const std::string& why) const {
    Fail(fmt::format("entry {} of {}: {}", entry_, Quoted(element_->name), why));
  }

  const Type* TypeOf(const std::string& name) const {
    const auto it = std::ranges::find_if(
        kTypes, [&](const Type& t) { return t.name == name || t.other_name == name; });
    if (it == std::end(kTypes)) Fail(fmt::format("the header's type {} is unknown", Quoted(name)));
    return it;
  }

  void ReadHeader() {
    constexpr std::size_t kLongest = 64 << 10;
    bool formatted = false, first = true;
    while (true) {
      const std::size_t end = text_.find_first_of("\r\n", at_);
      if (end == std::string::npos || end > kLongest) Fail("the header has no end_header");
      std::istringstream words(text_.substr(at_, end - at_));
      at_ = end + 1 + (text_.compare(end, 2, "\r\n") == 0 ? 1 : 0);
      std::string word, a, b, c, d;
      words >> word >> a >> b >> c >> d;
      if (first && word != "ply") Fail("the first line of a PLY file must be \"ply\"");
      first = false;
      if (word == "end_header") break;
      if (word == "format") {
        formatted = true;
        format_ = a == "ascii"                  ? Format::kAscii
                  : a == "binary_little_endian" ? Format::kLittle
                                                : Format::kBig;
        if (format_ == Format::kBig && a != "binary_big_endian")
          Fail(
              fmt::format("the format {} is unknown; allowed are ascii, binary_little_endian, "
                          "binary_big_endian",
                          Quoted(a)));
      } else if (word == "element") {
        Element element{a, 0, {}};
        const auto [rest, error] = std::from_chars(b.data(), b.data() + b.size(), element.count);
        if (error != std::errc() || rest != b.data() + b.size())
          Fail(fmt::format("the header's element {} has the count {}; must be 0 or more", Quoted(a),
                           Quoted(b)));
        if (std::ranges::find(elements_, a, &Element::name) != elements_.end())
          Fail(fmt::format("the header has a second element {}", Quoted(a)));
        elements_.push_back(element);
      } else if (word == "property") {
        if (elements_.empty()) Fail("the header has a property before the first element");
        const bool list = a == "list";
        if ((list ? d : b).empty()) Fail("the header has a property without a name");
        elements_.back().properties.push_back(
            {list ? d : b, TypeOf(list ? c : a), list ? TypeOf(b) : nullptr});
      }
    }
    if (!formatted) Fail("the header has no format");
  }

  /// Before anything is read: what a header claims costs nothing to write.
  void CheckCounts() const {
    std::uint64_t needed = 0;
    for (const Element& element : elements_) {
      std::uint64_t least = 0;
      for (const Property& property : element.properties)
        least += format_ == Format::kAscii ? 2u  // a digit, and what parts it from the next
                 : property.length         ? static_cast<unsigned>(property.length->bytes)
                                           : static_cast<unsigned>(property.type->bytes);
      const std::uint64_t most = element.name == "face" ? limits_.triangles : limits_.vertices;
      if (element.count > most)
        Fail(fmt::format("the header claims {} entries of {}; allowed are at most {}",
                         element.count, Quoted(element.name), most));
      needed += element.count * least;
      if (needed > text_.size() - at_ + 1)
        Fail(fmt::format("the header claims {} entries of {}: {} bytes at least; after it stand {}",
                         element.count, Quoted(element.name), needed, text_.size() - at_));
    }
    for (const char* name : {"vertex", "face"})
      if (std::ranges::find(elements_, name, &Element::name) == elements_.end())
        Fail(fmt::format("the header has no element {}", Quoted(name)));
  }

  double Next(const Type& type) {
    if (format_ == Format::kAscii) return NextWord();
    const auto n = static_cast<std::size_t>(type.bytes);
    if (text_.size() - at_ < n) FailHere("the file ends within it");
    std::array<char, 8> bytes{};
    std::copy_n(text_.data() + at_, n, bytes.data());
    at_ += n;
    if ((format_ == Format::kLittle) != (std::endian::native == std::endian::little))
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
  std::size_t Length(const Property& property) {
    const double length = Next(*property.length);
    if (!(length >= 0 && length <= static_cast<double>(text_.size())) ||
        length != std::floor(length))
      FailHere(fmt::format("a list of {:g} values", length));
    return static_cast<std::size_t>(length);
  }

  void ReadVertex() {
    Eigen::Vector3f v = Eigen::Vector3f::Constant(NAN);
    for (const Property& property : element_->properties) {
      std::size_t values = property.length ? Length(property) : 1;
      for (; values > 0; --values) {
        const double value = Next(*property.type);
        for (int k = 0; k < 3; ++k)
          if (property.name == std::string_view(&"xyz"[k], 1)) v[k] = static_cast<float>(value);
      }
    }
    if (!v.allFinite()) FailHere("x, y and z must be finite numbers");
    mesh_.vertices.push_back(v);
  }

  void ReadEntry(bool face) {
    for (const Property& property : element_->properties) {
      const bool corners = face && property.length &&
                           (property.name == "vertex_indices" || property.name == "vertex_index");
      std::size_t values = property.length ? Length(property) : 1;
      Eigen::Vector3i t = Eigen::Vector3i::Zero();
      for (std::size_t k = 0; k < values; ++k) {
        const double value = Next(*property.type);
        if (!corners) continue;
        if (!(value >= 0 && value <= 2e9) || value != std::floor(value))
          FailHere(fmt::format("the corner {:g}; must be the number of a vertex", value));
        t[1] = t[2];
        t[2] = static_cast<int>(value);
        if (k == 0) t[0] = t[2];
        if (k < 2) continue;
        if (mesh_.triangles.size() >= limits_.triangles)
          Fail(fmt::format("more than {} triangles", limits_.triangles));
        mesh_.triangles.push_back(t);
      }
    }
  }

  const MeshLimits& limits_;
  std::string text_;
  std::size_t at_ = 0;
  Format format_ = Format::kAscii;
  std::vector<Element> elements_;
  const Element* element_ = nullptr;  // that is read
  std::uint64_t entry_ = 0;
  RawMesh mesh_;
};

}  // namespace

RawMesh ReadPly(const std::filesystem::path& file, const MeshLimits& limits) {
  return Reader(file, limits).Read();
}

}  // namespace regrasp
