#pragma once

/// The other side of mesh_file.h: what runs in the child process, which parses a mesh file and
/// writes what it found into a pipe.

#include <cstdint>
#include <optional>
#include <string>

#include "core/hand/mesh_file.h"

namespace regrasp {

/// Precedes what the child sends: `text` bytes of an error, or vertices (3 floats each) and
/// triangles (3 ints each).
struct MeshHeader {
  std::uint32_t magic = kMagic;
  std::uint32_t text = 0;
  std::uint64_t vertices = 0, triangles = 0;
  static constexpr std::uint32_t kMagic = 0x6d657368;
};

/// How a file is read.
struct MeshKind {
  std::string suffix;                       ///< in lower case
  std::optional<std::uint64_t> stl_rest{};  ///< of a binary STL file: BinaryStlRest
};

/// After fork(): limits the process, reads the file, sends it to `out` and ends the process.
[[noreturn]] void RunMeshChild(const std::string& file, const MeshKind& kind, int out,
                               const MeshLimits& limits);

}  // namespace regrasp
