#pragma once

/// Mesh files as lists of triangles. The file is parsed by a child process with limits of time and
/// memory, because a damaged file may end, hang or fill the process that reads it.

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/common/frames.h"
#include "core/hand/model_error.h"

namespace regrasp {

/// Triangles as they stand in a file, in the file's own axes (a Collada file's <up_axis> turns
/// nothing; its <unit> does scale).
struct RawMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3i> triangles;  ///< indices into `vertices`, all in range
  std::uint64_t unread_bytes = 0;          ///< of the file, that are no triangle's
};

struct MeshLimits {
  double time_s = 10;                   ///< of the child, processor and wall clock
  std::size_t memory_bytes = 1u << 30;  ///< more than the parent has
  std::size_t file_bytes = 128u << 20;
  std::size_t vertices = 1000000;  ///< before equal ones are welded
  std::size_t triangles = 500000;
};

/// Reads an .obj, .stl, .ply, .dae or .glb file (by its suffix, in either case). Throws ModelError.
RawMesh ReadMeshFile(const std::filesystem::path& file, const MeshLimits& limits = {});

/// What the child sends back, read with every count and index checked. Throws ModelError, whose
/// message begins with `file`. For ReadMeshFile and its tests.
RawMesh DecodeMesh(const std::filesystem::path& file, std::span<const std::byte> bytes,
                   const MeshLimits& limits);

}  // namespace regrasp
