#pragma once

/// The object as it collides: a body of ODE's, or a mesh. Used only inside core/world.

#include <ode/ode.h>

#include <memory>
#include <vector>

#include "core/hand/object_model.h"
#include "core/world/collision_part.h"
#include "core/world/surface_mesh.h"

namespace regrasp {

/// A mesh as ODE holds it; only read once it is made.
class OdeMesh {
 public:
  OdeMesh(const std::vector<Vector3d>& vertices_O, const std::vector<Eigen::Vector3i>& triangles);
  ~OdeMesh() { dGeomTriMeshDataDestroy(data_); }
  OdeMesh(const OdeMesh&) = delete;
  OdeMesh& operator=(const OdeMesh&) = delete;
  dTriMeshDataID data() const { return data_; }

 private:
  std::vector<double> vertices_;
  std::vector<dTriIndex> indices_;
  dTriMeshDataID data_;
};

struct ObjectPart : CollisionPart {
  /// What a mesh needs, shared by all worlds of it: against capsules, against boxes.
  std::shared_ptr<const SurfaceMesh> surface;
  std::shared_ptr<const OdeMesh> mesh;

  ObjectPart(const ObjectModel& object, dBodyID object_body);
  /// Contacts with a part of the hand, at most kMaxPerPair, as Contacts(object, part). A capsule
  /// meets a mesh in one.
  int ContactsWith(const CollisionPart& part, dContactGeom* out) const;

 private:
  int MeshContact(const CollisionPart& part, dContactGeom* out) const;
};

}  // namespace regrasp
