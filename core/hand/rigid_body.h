#pragma once

/// Objects of several links that are fixed to each other. Used only by the object's loader.

#include "core/hand/urdf_file.h"

namespace regrasp {

/// The links as one, in the frame of the root: its name and line, the shapes and the sum of the
/// bodies of all. The lines of its <inertial> are those of the first that has mass. A joint that is
/// not fixed and, of several links, a mass that is missing or negative are problems.
UrdfLink OneBody(const UrdfFile& file, Problems* problems);

}  // namespace regrasp
