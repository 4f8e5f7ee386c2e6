#pragma once

/// Objects from URDF files.

#include <filesystem>

#include "core/hand/model_error.h"
#include "core/hand/model_report.h"
#include "core/hand/object_model.h"

namespace regrasp {

/// Loads and checks an object: one link (links fixed to it are merged) with its <collision>: a
/// sphere or cylinder (read as a capsule along z) whose middle is the centre of mass, unrotated; or
/// boxes and closed meshes, of any pose and number, which together are one surface. The origin is
/// moved to the centre of mass. A body that cannot be is refused with the flag that mends it. Adds
/// to `report` where given. Throws ModelError with all that is wrong, each with its line.
ObjectModel LoadObjectUrdf(const std::filesystem::path& urdf_file, const LoadOptions& options = {},
                           ModelReport* report = nullptr);

}  // namespace regrasp
