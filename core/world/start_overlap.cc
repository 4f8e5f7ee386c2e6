#include "core/world/start_overlap.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>

#include "core/common/box_corners.h"
#include "core/hand/mesh.h"
#include "core/world/surface_mesh.h"

namespace regrasp {
namespace {

/// Distance of a point from a box; negative inside.
double ToBox(const Vector3d& p, const Vector3d& half) {
  const Vector3d beyond = p.cwiseAbs() - half;
  return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
}

/// How far points lie from an object's surface; negative inside. Of points that lie `reach` or more
/// outside only that they do.
class ObjectDistance {
 public:
  explicit ObjectDistance(const ObjectModel& object) : object_(object) {
    if (object.kind != ObjectModel::Kind::kMesh) return;
    surface_ = SurfaceMesh::Shared(object.vertices_O, object.triangles);
    for (const Vector3d& v : object.vertices_O) box_.extend(v);
  }

  double operator()(const Vector3d& p_O, double reach) const {
    switch (object_.kind) {
      case ObjectModel::Kind::kSphere:
        return p_O.norm() - object_.radius;
      case ObjectModel::Kind::kBox:
        return ToBox(p_O, object_.half_extents);
      case ObjectModel::Kind::kMesh:
        break;
    }
    if (box_.contains(p_O) && IsInside(object_.vertices_O, object_.triangles, p_O)) {
      const double far = 2 * object_.bounding_radius + p_O.norm();
      return -surface_->ClosestToSegment(p_O, p_O, far)->distance;
    }
    const auto closest = surface_->ClosestToSegment(p_O, p_O, reach);
    return closest ? closest->distance : reach;
  }

 private:
  const ObjectModel& object_;
  std::shared_ptr<const SurfaceMesh> surface_;
  Eigen::AlignedBox3d box_;  // of a mesh
};

/// Points of the object's surface or core, and how far around each the object reaches.
struct Core {
  std::vector<Vector3d> points_O;
  double radius = 0;
};

Core CoreOf(const ObjectModel& object) {
  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
      return {{Vector3d::Zero()}, object.radius};
    case ObjectModel::Kind::kBox: {
      Core core{{Vector3d::Zero()}, 0};
      std::ranges::copy(BoxCorners(object.half_extents), std::back_inserter(core.points_O));
      return core;
    }
    case ObjectModel::Kind::kMesh:
      break;
  }
  return {object.vertices_O, 0};
}

double DepthOf(const Shape& shape, const Isometry3d& X_OL, const ObjectDistance& distance,
               const Core& core) {
  double depth = -1;
  if (shape.kind == Shape::Kind::kCapsule) {
    const int steps = shape.a_L == shape.b_L ? 0 : 8;
    for (int k = 0; k <= steps; ++k)
      depth = std::max(
          depth, shape.radius - distance(X_OL * (shape.b_L + k / 8.0 * (shape.a_L - shape.b_L)),
                                         shape.radius));
    return depth;
  }
  const Isometry3d X_OB = X_OL * shape.X_LB;
  for (int i = 0; i < 27; ++i)
    depth = std::max(depth, -distance(X_OB * shape.half_extents.cwiseProduct(
                                                 Vector3d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)),
                                      0.0));
  const Isometry3d X_BO = X_OB.inverse();
  for (const Vector3d& p_O : core.points_O)
    depth = std::max(depth, core.radius - ToBox(X_BO * p_O, shape.half_extents));
  return depth;
}

double Bound(const Shape& shape) {
  return shape.kind == Shape::Kind::kBox
             ? shape.X_LB.translation().norm() + shape.half_extents.norm()
             : std::max(shape.a_L.norm(), shape.b_L.norm()) + shape.radius;
}

}  // namespace

StartOverlap DeepestOverlap(const HandModel& hand, const std::vector<Isometry3d>& X_WL,
                            const ObjectModel& object, const Isometry3d& X_WO) {
  const ObjectDistance distance(object);
  const Core core = CoreOf(object);
  StartOverlap deepest;
  for (std::size_t l = 0; l < hand.links.size(); ++l) {
    const Isometry3d X_OL = X_WO.inverse() * X_WL[l];
    for (const Shape& shape : hand.links[l].shapes) {
      if (X_OL.translation().norm() > object.bounding_radius + Bound(shape)) continue;
      const double depth = DepthOf(shape, X_OL, distance, core);
      if (depth > deepest.depth) deepest = {static_cast<int>(l), depth};
    }
  }
  return deepest;
}

}  // namespace regrasp
