#pragma once

/// Collision of a fixed list of pairs: the object with every shape of the hand, and shapes of the
/// hand with each other where they can meet. No broad-phase structure: a bounding test per pair is
/// cheaper at this size. Used only inside core/world.

#include <ode/ode.h>

#include <vector>

#include "core/common/fixed_vector.h"
#include "core/common/frames.h"
#include "core/hand/hand_model.h"
#include "core/hand/object_model.h"
#include "core/world/articulation.h"
#include "core/world/object_part.h"

namespace regrasp {

/// A contact of the object. `geom.normal` points into the object, as ODE wants it when the object's
/// body is the first of the contact joint.
struct ObjectHit {
  int link = -1;
  int shape = 0;           ///< of the link's shapes
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
  struct Pair {
    int a = 0, b = 0;
  };

  std::vector<CollisionPart> parts_;
  std::vector<Pair> pairs_;
  ObjectPart object_;
};

}  // namespace regrasp
