#pragma once

/// What a binary glTF file asks of its reader. Used only by the child process (mesh_child.h).

#include <string>

namespace regrasp {

/// Why assimp would read other numbers from a .glb file than it holds, or "": it requires an
/// extension that assimp does not know, or has corners that are no floats (assimp 5.2 takes those
/// of KHR_mesh_quantization for floats). Of a file that is none of glTF 2 "" as well.
std::string WhyNoGltf(const std::string& file);

}  // namespace regrasp
