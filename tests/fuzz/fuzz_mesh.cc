// What the mesh reader's child may send, and what becomes of its triangles: refused with a
// ModelError, or a closed surface with a volume, and a shape fitted to it. (The parsers of the
// formats run in the child, whose death is an answer.)
//   cmake --preset fuzz && ninja -C build/fuzz fuzz_mesh && build/fuzz/tests/fuzz_mesh
//   -max_len=4096 tests/fuzz/corpus/mesh

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "core/hand/mesh.h"
#include "core/hand/shape_fit.h"
#include "core/hand/solid.h"

using namespace regrasp;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr double kScales[] = {1, -1, 0.001, 1e-9};
  const double scale = kScales[data[0] % 4];
  const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
  MeshLimits limits;
  limits.vertices = limits.triangles = 1000;
  try {
    const RawMesh raw = DecodeMesh("mesh.obj", bytes, limits);
    TriangleMesh mesh = WeldMesh(raw, Vector3d(scale, std::abs(scale), std::abs(scale)));
    for (const auto& t : mesh.triangles)
      for (const int corner : t)
        if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.vertices.size()) std::abort();
    if (data[0] & 16 && !mesh.triangles.empty()) (void)FitShape(mesh);
    CloseMesh("mesh.obj", scale < 0, &mesh);
    if (!(Volume(mesh) > 0)) std::abort();
    (void)MeshSolid(mesh);
  } catch (const ModelError&) {
  }
  return 0;
}
