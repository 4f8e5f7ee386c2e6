#pragma once

/// Binary STL meshes, read by the child process (mesh_file.h) but not by assimp: that refuses a
/// file with bytes after its triangles, which exporters of robots do write. Text is assimp's.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/hand/mesh_file.h"

namespace regrasp {

/// Bytes of a binary STL file of `size` bytes that are no triangle's; nothing where it is text.
/// Binary is what is long enough for the triangles it claims, whatever it begins with: to be taken
/// for that, a text would have to be larger than 7 GB. Throws ModelError, without the file's name,
/// where the file is neither.
std::optional<std::uint64_t> BinaryStlRest(const std::filesystem::path& file, std::uint64_t size);

/// The triangles, each with three vertices of its own. Where the file's length is that of
/// triangles each followed by as many bytes as its attribute count says, those are passed over;
/// otherwise the counts are colours or nothing, and what is left stands at the end. Throws
/// ModelError, without the file's name.
RawMesh ReadBinaryStl(const std::filesystem::path& file, const MeshLimits& limits);

}  // namespace regrasp
