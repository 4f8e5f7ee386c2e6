#pragma once

/// The contacts of a grasp about its object, and the first ones of a rotation or a move, against
/// which everything later is judged.

#include <array>

#include "core/control/control_tick.h"
#include "core/control/object_wrench.h"

namespace regrasp {

/// One contact of a stance, from the object's reference position and in W axes: unlike those of a
/// Landing (landing_plan.h), which are in O, they do not turn with the object.
struct StanceContact {
  Vector3d p_OC_W = Vector3d::Zero();     ///< contact [m]
  Vector3d p_OF_W = Vector3d::Zero();     ///< fingertip centre [m]
  Vector3d normal_W = Vector3d::UnitZ();  ///< outward
  template <typename V>
  void Fields(V& v) {
    v("p_OC", p_OC_W);
    v("p_OF", p_OF_W);
    v("normal_W", normal_W);
  }
};
/// One contact per finger of the hand.
using Stance = FixedVector<StanceContact, kMaxFingers>;

/// Moves a contact over the surface by `step` (tangential, [m]). Surface model: the sphere through
/// the contact with the contact's normal and its distance from the object's centre as radius.
StanceContact Shifted(const StanceContact& contact, const Vector3d& step);

/// What the grasp looked like at first: the ends of object motion are judged against it, and the
/// fingers of the gait come back to it.
struct Home {
  Vector3d p_WO = Vector3d::Zero();                  ///< object reference [m]
  Stance stance;                                     ///< about that reference
  std::array<double, kMaxFingers> manipulability{};  ///< [kManipulabilityUnit]
  template <typename V>
  void Fields(V& v) {
    v("p_WO", p_WO);
    v("stance", stance);
    v("manipulability", manipulability);
  }
};
/// The present contacts of every finger, about the object's present reference.
Home MakeHome(const Estimate& estimate, const ObjectWrench& wrench);

}  // namespace regrasp
