#pragma once

/// PLY meshes (ascii, binary of either byte order), read here and not by assimp: that takes the
/// first byte of binary vertices for a line's end where it looks like one, and does not come back
/// from a header without an end.

#include <filesystem>

#include "core/hand/mesh_file.h"

namespace regrasp {

/// Vertices (properties x, y, z) and faces (a list vertex_indices or vertex_index), which are cut
/// into triangles from their first corner; every other property and element is passed over. Throws
/// ModelError: a header that is none or claims more than the file can hold or `limits` allow, a
/// value that is no number, a corner that is no vertex.
RawMesh ReadPly(const std::filesystem::path& file, const MeshLimits& limits);

}  // namespace regrasp
