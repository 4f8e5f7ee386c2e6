#pragma once

/// The object's true surface, for judging what was felt of it.

#include <memory>
#include <vector>

#include "core/hand/object_model.h"
#include "core/world/surface_mesh.h"

namespace regrasp {

class TrueSurface {
 public:
  explicit TrueSurface(const ObjectModel& object);

  struct Nearest {
    double distance = 0;                    ///< signed, positive outside [m]
    Vector3d normal_O = Vector3d::UnitZ();  ///< outward, of the surface there (mean at an edge)
  };
  /// The surface nearest to a point in O; inside overlapping pieces, that of the nearest piece.
  /// Takes time in proportion to a mesh's triangles. Allocates nothing.
  Nearest At(const Vector3d& p_O) const;

 private:
  ObjectModel::Kind kind_;
  double radius_;
  Vector3d half_extents_;
  std::vector<Vector3d> vertices_O_;
  std::vector<Eigen::Vector3i> triangles_;
  std::shared_ptr<const SurfaceMesh> mesh_;  // of both
};

}  // namespace regrasp
