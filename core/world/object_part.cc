#include "core/world/object_part.h"

#include <optional>

#include "core/world/last_mesh.h"

namespace regrasp {
namespace {

std::shared_ptr<const OdeMesh> SharedOdeMesh(const ObjectModel& object) {
  static LastMesh<OdeMesh> last;
  return last.Of(object.vertices_O, object.triangles);
}

}  // namespace

OdeMesh::OdeMesh(const std::vector<Vector3d>& vertices_O,
                 const std::vector<Eigen::Vector3i>& triangles)
    : data_(dGeomTriMeshDataCreate()) {
  for (const Vector3d& v : vertices_O) vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
  for (const Eigen::Vector3i& t : triangles)
    for (int k = 0; k < 3; ++k) indices_.push_back(static_cast<dTriIndex>(t[k]));
  dGeomTriMeshDataBuildDouble(data_, vertices_.data(), 3 * sizeof(double),
                              static_cast<int>(vertices_O.size()), indices_.data(),
                              static_cast<int>(indices_.size()), 3 * sizeof(dTriIndex));
}

ObjectPart::ObjectPart(const ObjectModel& object, dBodyID object_body) {
  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
      geom = dCreateSphere(nullptr, object.radius);
      break;
    case ObjectModel::Kind::kBox:
      geom = dCreateBox(nullptr, 2 * object.half_extents.x(), 2 * object.half_extents.y(),
                        2 * object.half_extents.z());
      box = true;
      half = object.half_extents;
      break;
    case ObjectModel::Kind::kMesh:
      surface = SurfaceMesh::Shared(object.vertices_O, object.triangles);
      mesh = SharedOdeMesh(object);
      geom = dCreateTriMesh(nullptr, mesh->data(), nullptr, nullptr, nullptr);
      box = true;  // may rest on a box with several contacts
      break;
  }
  body = object_body;
  bound = object.bounding_radius;
  dGeomSetBody(geom, body);
}

int ObjectPart::ContactsWith(const CollisionPart& part, dContactGeom* out) const {
  return surface && !part.box ? MeshContact(part, out) : Contacts(*this, part, out);
}

int ObjectPart::MeshContact(const CollisionPart& part, dContactGeom* out) const {
  const Matrix3d R_WO = RotationOf(body);
  const auto in_object = [&](const Vector3d& p_B) -> Vector3d {
    const Vector3d p_W = part.body ? PointNow(part.body, p_B) : p_B;
    return R_WO.transpose() * (p_W - p_WM);
  };
  const std::optional<SurfaceMesh::Closest> closest =
      surface->ClosestToSegment(in_object(part.p_BA), in_object(part.p_BC), part.radius);
  if (!closest) return 0;
  // The normal runs from the surface to the capsule's core; where the core has gone under the
  // surface the two change places.
  const Vector3d gap = closest->p_OSegment - closest->p_OSurface;
  const bool inside = gap.dot(closest->outward_O) < 0;
  const double distance = inside ? -closest->distance : closest->distance;
  const Vector3d normal_O =
      closest->distance > 1e-9 ? Vector3d(gap / distance) : closest->outward_O;
  const double depth = part.radius - distance;
  const Vector3d p_W = R_WO * (closest->p_OSurface - 0.5 * depth * normal_O) + p_WM;
  const Vector3d normal_W = R_WO * normal_O;
  *out = dContactGeom{};
  for (int k = 0; k < 3; ++k) {
    out->pos[k] = p_W[k];
    out->normal[k] = -normal_W[k];
  }
  out->depth = depth;
  return 1;
}

}  // namespace regrasp
