#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/common/frames.h"
#include "core/hand/mesh_file.h"
#include "core/hand/model_error.h"

namespace regrasp {

struct TriangleMesh {
  std::vector<Vector3d> vertices;          ///< [m]
  std::vector<Eigen::Vector3i> triangles;  ///< counter-clockwise seen from outside
  std::uint64_t unread_bytes = 0;          ///< RawMesh's
};

/// Corners nearer than this are one [m]; or nearer than 1e-6 of the mesh's size, if that is more.
inline constexpr double kWeld = 1e-6;

/// Scales a mesh, welds its corners and drops triangles with two equal corners, repeated triangles
/// and corners that no triangle uses. A mirroring scale turns the triangles, so that they face the
/// side they faced. `scale`: per axis, not 0.
TriangleMesh WeldMesh(const RawMesh& raw, const Vector3d& scale);

/// WeldMesh of a file, for shapes that are fitted: need not be closed. Throws ModelError.
TriangleMesh LoadMesh(const std::filesystem::path& file, const Vector3d& scale);

/// The same for a body: its surface must be closed (every edge is run through as often in one sense
/// as in the other, so that several closed pieces may touch) and face outwards (its volume is
/// positive; a mirrored mesh is turned; a piece that faces inwards is a cavity of another).
/// Triangles without area are taken out (FlipFlat). Throws ModelError.
TriangleMesh LoadClosedMesh(const std::filesystem::path& file,
                            const Vector3d& scale = Vector3d::Ones());

/// The checks of LoadClosedMesh on a welded mesh. `mirrored`: the scale was.
void CloseMesh(const std::filesystem::path& file, bool mirrored, TriangleMesh* mesh);

/// What a user is told of a mesh with unread bytes.
std::string UnreadBytes(const std::filesystem::path& file, const TriangleMesh& mesh);

/// Volume enclosed by a closed mesh: sum over triangles of det(a, b, c) / 6.
double Volume(const TriangleMesh& mesh);

/// The triangles of each surface that shares no corner with another.
std::vector<std::vector<Eigen::Vector3i>> PiecesOf(const TriangleMesh& mesh);

/// Whether a point lies inside closed surfaces (inside one of them, where they overlap): the solid
/// angle under which they are seen is 4 pi from inside, 0 from outside [Van Oosterom, Strackee
/// 1983].
bool IsInside(const std::vector<Vector3d>& vertices, const std::vector<Eigen::Vector3i>& triangles,
              const Vector3d& p);

}  // namespace regrasp
