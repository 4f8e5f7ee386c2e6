#pragma once

/// One shape of a hand's link, or the object, as ODE collides it. Used only inside core/world.

#include <ode/ode.h>

#include "core/common/frames.h"
#include "core/hand/hand_model.h"

namespace regrasp {

inline constexpr int kMaxPerPair = 4;  ///< contacts

struct CollisionPart {
  dGeomID geom = nullptr;
  dBodyID body = nullptr;  ///< nullptr: part of the static palm
  int link = -1;
  int shape = 0;                     ///< of the link's shapes
  bool box = false;                  ///< may rest on a box with several contacts
  Vector3d p_BM = Vector3d::Zero();  ///< middle of the bounding sphere in the body (static: in W)
  Vector3d p_BA = Vector3d::Zero(),
           p_BC = Vector3d::Zero();          ///< capsule: ends of the segment, as p_BM
  double radius = 0;                         ///< capsule [m]
  double bound = 0;                          ///< of the bounding sphere [m]
  Isometry3d X_WS = Isometry3d::Identity();  ///< static box
  Vector3d half = Vector3d::Zero();
  Vector3d p_WM = Vector3d::Zero();  ///< this step
};

/// A shape of `link`. X_BL: the link frame in the frame of its body, or in W without one.
CollisionPart PartOf(const Shape& shape, int link, dBodyID body, const Isometry3d& X_BL);

Matrix3d RotationOf(dBodyID body);
/// The point p_B of a body, in W.
Vector3d PointNow(dBodyID body, const Vector3d& p_B);

/// False where their bounds say that the parts are apart; by p_WM.
bool MayTouch(const CollisionPart& a, const CollisionPart& b);

/// Contacts between two parts by ODE, the deepest: kMaxPerPair of two boxes, else one.
int Contacts(const CollisionPart& a, const CollisionPart& b, dContactGeom* out);

}  // namespace regrasp
