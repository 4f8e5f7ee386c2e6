#pragma once

/// Objects from URDF files.

#include <filesystem>

#include "core/hand/model_error.h"
#include "core/hand/model_report.h"
#include "core/hand/object_model.h"

namespace regrasp {

/// What the file says that is not simulated; for `regrasp object show`.
struct ObjectFacts {
  bool inertia_told = true;            ///< inertia_as_told: else the object's is 0
  Vector3d p_LCom = Vector3d::Zero();  ///< centre of mass in the link's frame [m]
  int collisions = 0;                  ///< <collision> elements
  int pieces = 0;                      ///< closed surfaces that share no corner
  double overlap_m3 = 0;               ///< volume that lies in several pieces, counted once
};

/// Loads and checks an object: one link with its <collision> elements, of any pose and number:
/// spheres, cylinders, boxes and closed meshes, which together are one body. A
/// sphere, capsule or box alone, in the link's axes about the centre of mass, stays what it is;
/// anything else becomes one mesh (round pieces by facets, primitive_mesh.h), and where pieces
/// overlap the body is their union. The origin is moved to the centre of mass, and the link
/// turned by `R_OL` first. A body that cannot be is refused, and the flag that takes it all the
/// same is named; inertia_as_told takes its inertia as the file has it. Adds to `report` and
/// `facts` where given. Throws ModelError with all that is wrong, each with its line.
ObjectModel LoadObjectUrdf(const std::filesystem::path& urdf_file, const LoadOptions& options = {},
                           ModelReport* report = nullptr, ObjectFacts* facts = nullptr,
                           const Matrix3d& R_OL = Matrix3d::Identity());

/// The same with what the .toml file of the same name beside it says: friction,
/// rotation_deg (a rotation vector: how the link is turned to be presented to the hand),
/// inertia_from_shape, force. The object is called as the file.
ObjectModel LoadObjectFile(const std::filesystem::path& urdf_file, LoadOptions options = {},
                           ModelReport* report = nullptr, ObjectFacts* facts = nullptr);

}  // namespace regrasp
