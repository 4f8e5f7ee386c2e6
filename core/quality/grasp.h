#pragma once

/// A grasp as a set of point contacts with friction: what every stability measure takes.

#include "core/common/fixed_vector.h"
#include "core/common/frames.h"
#include "core/common/limits.h"

namespace regrasp {

struct GraspContact {
  Vector3d position = Vector3d::Zero();  ///< from the centre about which moments are taken [m]
  Vector3d inward_normal = Vector3d::UnitZ();  ///< unit, into the object
  double mu = 0.8;                             ///< friction coefficient
  /// Soft finger: largest torsional moment about the normal over the normal force [m]; 0: a hard
  /// finger. Tangential force and moment share an ellipsoid, (f_t / mu)² + (m / torsion)² <= f_n²
  /// [Howe, Cutkosky 1996].
  double torsion = 0;

  template <typename V>
  void Fields(V& v) {
    v("position", position);
    v("inward_normal", inward_normal);
    v("mu", mu);
    v("torsion", torsion);
  }
};

/// Contacts of one grasp; larger grasps (evaluate FILE) pass a std::vector of the same element.
using Grasp = FixedVector<GraspContact, kMaxFingers>;

/// Tangent axes of a contact: t1 = n x e_x (n x e_z where n is parallel to e_x), t2 = n x t1, unit.
struct TangentBasis {
  Vector3d t1, t2;
};
TangentBasis ContactTangents(const Vector3d& inward_normal);

}  // namespace regrasp
