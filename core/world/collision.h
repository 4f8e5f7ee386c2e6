#pragma once

/// Collision of a fixed list of pairs: the object with every shape of the hand, and shapes of the
/// hand with each other where they can meet. No broad-phase structure: a bounding test per pair is
/// cheaper at this size. Used only inside core/world.

#include <ode/ode.h>

#include <memory>
#include <vector>

#include "core/common/fixed_vector.h"
#include "core/common/frames.h"
#include "core/hand/hand_model.h"
#include "core/hand/object_model.h"
#include "core/world/articulation.h"
#include "core/world/surface_mesh.h"

namespace regrasp {

/// A contact of the object. `geom.normal` points into the object, as ODE wants it when the object's
/// body is the first of the contact joint.
struct ObjectHit {
  int link = -1;
  dBodyID body = nullptr;  ///< nullptr: the static palm
  dContactGeom geom{};
};

/// A contact between two links.
struct LinkHit {
  int link_a = -1, link_b = -1;
  dBodyID body_a = nullptr, body_b = nullptr;
  dContactGeom geom{};
};

inline constexpr int kMaxLinkHits = 32;

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

class Collider {
 public:
  /// `bodies[i]` is articulation.bodies[i], already at its pose of the start posture; X_WL are the
  /// link poses there. Shapes of neighbouring bodies, and shapes that overlap in the start posture,
  /// are taken to overlap by construction and are never tested against each other.
  Collider(const HandModel& hand, const Articulation& articulation, const ObjectModel& object,
           const std::vector<dBodyID>& bodies, const std::vector<Isometry3d>& X_WL,
           dBodyID object_body);
  ~Collider();
  Collider(const Collider&) = delete;
  Collider& operator=(const Collider&) = delete;
  /// Forgets the shapes without touching ODE (after a fault).
  void Abandon();

  /// Fills both lists, the object's in the order of the links; of more than fit, the shallowest are
  /// left out. At most one contact (the deepest) per pair, four for a box or a
  /// mesh on a box.
  void Collide(FixedVector<ObjectHit, kMaxObjectContacts>* object_hits,
               FixedVector<LinkHit, kMaxLinkHits>* link_hits);

 private:
  struct Part {
    dGeomID geom = nullptr;
    dBodyID body = nullptr;
    int link = -1;
    bool box = false;
    Vector3d p_BM = Vector3d::Zero();  // middle of the bounding sphere in the body (static: in W)
    Vector3d p_BA = Vector3d::Zero(),
             p_BC = Vector3d::Zero();          // capsule: ends of the segment, as p_BM
    double radius = 0;                         // capsule [m]
    double bound = 0;                          // its radius [m]
    Isometry3d X_WS = Isometry3d::Identity();  // static box
    Vector3d half = Vector3d::Zero();
    Vector3d p_WM = Vector3d::Zero();  // this step
  };
  struct Pair {
    int a = 0, b = 0;
  };

  bool MayTouch(const Part& a, const Part& b) const;
  int ObjectContacts(const Part& part, dContactGeom* out) const;
  int MeshContact(const Part& part, dContactGeom* out) const;
  static int Contacts(const Part& a, const Part& b, dContactGeom* out);

  std::vector<Part> parts_;
  std::vector<Pair> pairs_;
  Part object_;
  // Of a mesh object, shared by all worlds of it: against capsules, against boxes.
  std::shared_ptr<const SurfaceMesh> surface_;
  std::shared_ptr<const OdeMesh> mesh_;
};

}  // namespace regrasp
