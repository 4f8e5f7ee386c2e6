#pragma once

/// PLY meshes (ascii, binary of either byte order), read by the child process (mesh_file.h) but not
/// by assimp: that takes the first byte of binary vertices for a line's end where it looks like
/// one, and does not come back from a header without an end.

#include <filesystem>

#include "core/hand/mesh_file.h"

namespace regrasp {

/// Vertices (properties x, y, z) and faces (a list vertex_indices or vertex_index), which are cut
/// into triangles from their first corner; every other property and element is passed over. Throws
/// ModelError, without the file's name: a header that is none or claims more than the file can hold
/// or `limits` allow, a value that is no number. Corners beyond the last vertex are left to
/// DecodeMesh.
RawMesh ReadPly(const std::filesystem::path& file, const MeshLimits& limits);

}  // namespace regrasp
