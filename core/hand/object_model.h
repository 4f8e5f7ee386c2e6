#pragma once

/// The object in the hand, as the simulator knows it. The controller never sees this type.

#include <string>
#include <vector>

#include "core/common/frames.h"

namespace regrasp {

/// What an object may have, as its file, as a parameter and as a saved state.
inline constexpr double kLeastFriction = 1e-3, kMostFriction = 1;
inline constexpr double kLeastObjectMass = 1e-4, kMostObjectMass = 100;  ///< [kg]

struct ObjectModel {
  /// As run files number them; 2 was a capsule.
  enum class Kind { kSphere = 0, kBox = 1, kMesh = 3 };
  std::string name;
  Kind kind = Kind::kSphere;
  double radius = 0.025;                     ///< sphere [m]
  Vector3d half_extents = Vector3d::Zero();  ///< box [m]
  std::vector<Vector3d> vertices_O;          ///< mesh [m]
  std::vector<Eigen::Vector3i> triangles;    ///< mesh, counter-clockwise seen from outside
  double mass = 0.08;                        ///< [kg]
  Matrix3d I_OCom =
      Matrix3d::Zero();   ///< inertia about the origin, which is the centre of mass [kg m²]
  double friction = 0.8;  ///< Coulomb coefficient of every contact, kLeastFriction .. 1
  double bounding_radius = 0.025;  ///< farthest surface point from the origin [m]
};

}  // namespace regrasp
