#include "core/hand/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <sstream>

#include "core/hand/mesh_text.h"
#include "core/hand/urdf_values.h"

namespace regrasp {
namespace {

constexpr PlyType kTypes[] = {{"char", "int8", 1, 'i'},     {"uchar", "uint8", 1, 'u'},
                              {"short", "int16", 2, 'i'},   {"ushort", "uint16", 2, 'u'},
                              {"int", "int32", 4, 'i'},     {"uint", "uint32", 4, 'u'},
                              {"float", "float32", 4, 'f'}, {"double", "float64", 8, 'f'}};

[[noreturn]] void Fail(const std::string& why) { throw ModelError(why); }

const PlyType* TypeOf(const std::string& name) {
  const auto it = std::ranges::find_if(
      kTypes, [&](const PlyType& t) { return t.name == name || t.other_name == name; });
  if (it == std::end(kTypes)) Fail(fmt::format("the header's type {} is unknown", Quoted(name)));
  return it;
}

PlyHeader ParseHeader(const std::string& text) {
  PlyHeader header;
  std::vector<PlyElement>& elements = header.elements;
  constexpr std::size_t kLongest = 64 << 10;
  bool formatted = false, first = true;
  if (text.starts_with(kByteOrderMark)) header.bytes = kByteOrderMark.size();
  while (true) {
    const std::size_t end = text.find_first_of("\r\n", header.bytes);
    if (end == std::string::npos || end > kLongest) Fail("the header has no end_header");
    std::istringstream words(text.substr(header.bytes, end - header.bytes));
    header.bytes = end + 1 + (text.compare(end, 2, "\r\n") == 0 ? 1 : 0);
    std::string word, a, b, c, d;
    words >> word >> a >> b >> c >> d;
    if (first && word != "ply") Fail("the first line of a PLY file must be \"ply\"");
    first = false;
    if (word == "end_header") break;
    if (word == "format") {
      formatted = true;
      header.format = a == "ascii"                  ? PlyHeader::Format::kAscii
                      : a == "binary_little_endian" ? PlyHeader::Format::kLittle
                                                    : PlyHeader::Format::kBig;
      if (header.format == PlyHeader::Format::kBig && a != "binary_big_endian")
        Fail(
            fmt::format("the format {} is unknown; allowed are ascii, binary_little_endian, "
                        "binary_big_endian",
                        Quoted(a)));
    } else if (word == "element") {
      PlyElement element{a, 0, {}};
      const auto [rest, error] = std::from_chars(b.data(), b.data() + b.size(), element.count);
      if (error != std::errc() || rest != b.data() + b.size())
        Fail(fmt::format("the header's element {} has the count {}; must be 0 or more", Quoted(a),
                         Quoted(b)));
      if (std::ranges::find(elements, a, &PlyElement::name) != elements.end())
        Fail(fmt::format("the header has a second element {}", Quoted(a)));
      elements.push_back(element);
    } else if (word == "property") {
      if (elements.empty()) Fail("the header has a property before the first element");
      const bool list = a == "list";
      if ((list ? d : b).empty()) Fail("the header has a property without a name");
      elements.back().properties.push_back(
          {list ? d : b, TypeOf(list ? c : a), list ? TypeOf(b) : nullptr});
    }
  }
  if (!formatted) Fail("the header has no format");
  return header;
}

/// Before anything is read: what a header claims costs nothing to write.
void CheckCounts(const PlyHeader& header, const std::string& text, const MeshLimits& limits) {
  std::uint64_t needed = 0;
  for (const PlyElement& element : header.elements) {
    std::uint64_t least = 0;
    for (const PlyProperty& property : element.properties)
      least += header.format == PlyHeader::Format::kAscii
                   ? 2u  // a digit, and what parts it from the next
               : property.length ? static_cast<unsigned>(property.length->bytes)
                                 : static_cast<unsigned>(property.type->bytes);
    const std::uint64_t most = element.name == "face" ? limits.triangles : limits.vertices;
    if (element.count > most)
      Fail(fmt::format("the header claims {} entries of {}; allowed are at most {}", element.count,
                       Quoted(element.name), most));
    needed += element.count * least;
    if (needed > text.size() - header.bytes + 1)
      Fail(fmt::format("the header claims {} entries of {}: {} bytes at least; after it stand {}",
                       element.count, Quoted(element.name), needed, text.size() - header.bytes));
  }
  for (const char* name : {"vertex", "face"})
    if (std::ranges::find(header.elements, name, &PlyElement::name) == header.elements.end())
      Fail(fmt::format("the header has no element {}", Quoted(name)));
}

}  // namespace

PlyHeader ReadPlyHeader(const std::string& text, const MeshLimits& limits) {
  PlyHeader header = ParseHeader(text);
  CheckCounts(header, text, limits);
  return header;
}

}  // namespace regrasp
