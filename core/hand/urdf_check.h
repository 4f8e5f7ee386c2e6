#pragma once

/// Whether a URDF document says what it must, each in its place, before it is built into a model.

#include <tinyxml2.h>

#include <filesystem>

#include "core/hand/problems.h"

namespace regrasp {

inline constexpr const char* kLacking = "lacking";

/// Adds every mistake of <robot> to `problems` with its line: unreadable numbers, missing elements,
/// unknown names, a tree that is none. Where there is none, the document holds what urdfdom is to
/// read and nothing else: <visual>, <gazebo>, <transmission>, <material> and the like are gone,
/// numbers stand with one space between, <mesh filename> is the file (and "written" what was
/// written), a joint that moves has a <limit> (of line 0 where the file has none), whose velocity
/// nobody uses, and <dynamics> only where a damping is given. A <mass>, <inertia> or <limit effort>
/// that the file has not is 0, and its element has the attribute kLacking. Warns of what is gone
/// though it may matter (urdf_unused.h).
void CheckUrdf(const std::filesystem::path& path, tinyxml2::XMLElement* robot, Problems* problems);

}  // namespace regrasp
