#pragma once

/// PLY meshes (ascii, binary of either byte order), read by the child process (mesh_file.h) but not
/// by assimp, except to cut polygons: that takes the first byte of binary vertices for a line's end
/// where it looks like one, and does not come back from a header without an end.

#include <filesystem>
#include <string>
#include <vector>

#include "core/hand/mesh_file.h"

namespace regrasp {

/// Faces of any number of corners, as a PLY file has them.
struct PolygonMesh {
  RawMesh mesh;                            ///< the vertices, and the faces of three corners
  std::vector<std::vector<int>> polygons;  ///< those of more
  std::size_t triangles = 0;               ///< that all of them are cut into
};

/// Vertices (properties x, y, z) and faces (a list vertex_indices or vertex_index); every other
/// property and element is passed over. Throws ModelError, without the file's name: a header that
/// is none or claims more than the file can hold or `limits` allow, a value that is no number; in a
/// file with polygons also a corner beyond the last vertex. In one of triangles only that is left
/// to DecodeMesh.
PolygonMesh ReadPly(const std::filesystem::path& file, const MeshLimits& limits);

/// The same mesh as an OBJ file: what cuts polygons into triangles, concave ones too, reads that.
std::string ObjText(const PolygonMesh& mesh);
/// The polygons cut from their first corner, which is wrong where one is concave.
RawMesh Fans(PolygonMesh mesh);

}  // namespace regrasp
