#pragma once

/// The felt surface as a file that other programs open.

#include <string>

#include "cli/client/client.h"

namespace regrasp::cli {

/// `mesh` as the method `shape` answers it. PLY, text: vertices [m] in the object's frame, normals,
/// unknown [rad] and error [m] of each, triangles.
std::string PlyText(const Json& mesh);
/// STL, binary: triangles only [m].
std::string StlText(const Json& mesh);

}  // namespace regrasp::cli
