// Mesh files: refused with a ModelError, or triangles whose corners are there. The first byte names
// the format. The readers of our own ("p" PLY, "s" binary STL) run in this process; "t" (text STL),
// "o" OBJ, "d" Collada, "g" glTF and, by its suffix, "P" PLY and "S" STL as users read them: by the
// child process, whose death is an answer.
//   cmake --preset fuzz && ninja -C build/fuzz fuzz_mesh_file && build/fuzz/tests/fuzz_mesh_file
//   -max_len=4096 tests/fuzz/corpus/mesh_file

#include <fmt/format.h>
#include <unistd.h>

#include <string>

#include "core/hand/mesh.h"
#include "core/hand/ply_file.h"
#include "core/hand/stl_file.h"
#include "tests/fuzz/model_file.h"

namespace {

using namespace regrasp;

const MeshLimits& Limits() {
  static const MeshLimits limits = [] {
    MeshLimits few;
    few.vertices = few.triangles = 1000;
    few.time_s = 2;
    return few;
  }();
  return limits;
}

void Require(bool condition) {
  if (!condition) std::abort();
}

/// A link to `file` that ends in `suffix`, and that the child process can follow too.
std::filesystem::path Named(const std::filesystem::path& file, const std::string& suffix) {
  const std::filesystem::path name =
      std::filesystem::temp_directory_path() / fmt::format("regrasp_fuzz_{}{}", ::getpid(), suffix);
  std::error_code ignored;
  std::filesystem::remove(name, ignored);
  std::filesystem::create_symlink(
      fmt::format("/proc/{}/fd/{}", ::getpid(), file.filename().string()), name);
  return name;
}

void Read(char format, const std::filesystem::path& file, std::size_t size) {
  const auto in_process = [&](const RawMesh& mesh) {
    Require(mesh.vertices.size() <= Limits().vertices &&
            mesh.triangles.size() <= Limits().triangles);
  };
  if (format == 'p') return in_process(ReadPly(file, Limits()).mesh);
  if (format == 's') {
    if (BinaryStlRest(file, size)) in_process(ReadBinaryStl(file, Limits()));
    return;
  }
  const char* suffix = format == 't' || format == 'S' ? ".stl"
                       : format == 'o'                ? ".obj"
                       : format == 'd'                ? ".dae"
                       : format == 'g'                ? ".glb"
                                                      : ".ply";
  const std::filesystem::path name = Named(file, suffix);
  RawMesh mesh;
  try {
    mesh = ReadMeshFile(name, Limits());
  } catch (const ModelError&) {
  }
  std::filesystem::remove(name);
  for (const Eigen::Vector3i& t : mesh.triangles)
    Require(t.minCoeff() >= 0 && t.maxCoeff() < static_cast<int>(mesh.vertices.size()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static ModelFile file;
  if (size == 0 || std::string("pstodgPS").find(static_cast<char>(data[0])) == std::string::npos)
    return -1;
  file.Write(data + 1, size - 1);
  try {
    Read(static_cast<char>(data[0]), file.path(), size - 1);
  } catch (const ModelError&) {
  }
  return 0;
}
