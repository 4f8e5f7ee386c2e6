#pragma once

/// In which unit a mesh may be that is too large in metres.

#include <string>

namespace regrasp {

/// "; if the file is in millimetres: <mesh scale=...>" and so on, for every unit in which a length
/// of `size` (of a link's mesh, or the bounding radius of an object) is 5 to 200 mm; where none is,
/// in which it lies in `least` .. `most`; "" where none is. [m]
std::string UnitHint(double size, double least, double most);

}  // namespace regrasp
