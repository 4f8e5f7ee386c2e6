#include "core/world/true_surface.h"

#include <algorithm>

#include "core/hand/mesh.h"

namespace regrasp {

TrueSurface::TrueSurface(const ObjectModel& object)
    : kind_(object.kind),
      radius_(object.radius),
      half_extents_(object.half_extents),
      vertices_O_(object.vertices_O),
      triangles_(object.triangles) {
  if (kind_ == ObjectModel::Kind::kMesh)
    mesh_ = SurfaceMesh::Shared(object.vertices_O, object.triangles);
}

TrueSurface::Nearest TrueSurface::At(const Vector3d& p) const {
  switch (kind_) {
    case ObjectModel::Kind::kSphere:
      return {p.norm() - radius_, p.normalized()};
    case ObjectModel::Kind::kBox: {
      const Vector3d beyond = p.cwiseAbs() - half_extents_;
      int axis = 0;
      const double deepest = beyond.maxCoeff(&axis);
      const Vector3d sign = p.cwiseSign();
      if (deepest <= 0) return {deepest, sign[axis] * Vector3d::Unit(axis)};
      const Vector3d out = beyond.cwiseMax(0.0);
      return {out.norm(), out.cwiseProduct(sign).normalized()};
    }
    case ObjectModel::Kind::kMesh: {
      constexpr double kAnywhere = 1.0;  // [m]
      const auto closest = mesh_->ClosestToSegment(p, p, kAnywhere);
      if (!closest) return {kAnywhere, Vector3d::UnitZ()};
      const bool inside = IsInside(vertices_O_, triangles_, p);
      return {inside ? -closest->distance : closest->distance, closest->outward_O};
    }
  }
  return {};
}

}  // namespace regrasp
