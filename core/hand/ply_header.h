#pragma once

/// The header of a PLY file: the elements that follow it, and how their values are written. Used
/// only by ply_file.cc.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/hand/mesh_file.h"

namespace regrasp {

struct PlyType {
  std::string_view name, other_name;
  int bytes;
  char kind;  ///< of a number: i, u, f
};

struct PlyProperty {
  std::string name;
  const PlyType* type = nullptr;
  const PlyType* length = nullptr;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  enum class Format { kAscii, kLittle, kBig };
  Format format = Format::kAscii;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  ///< its own: the entries begin there
};

/// Reads the header at the beginning of a file's `text`. Throws ModelError where there is none, or
/// where it lacks vertices or faces or claims more of them than the file can hold or `limits`
/// allow.
PlyHeader ReadPlyHeader(const std::string& text, const MeshLimits& limits);

}  // namespace regrasp
