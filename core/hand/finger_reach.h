#pragma once

/// Where one finger can put its tip, and how far it can follow a turning object from there: inverse
/// kinematics of a single finger, the others left out. A microsecond per step, no allocation.

#include "core/common/fixed_vector.h"
#include "core/hand/kinematics.h"
#include "core/hand/reach_rule.h"

namespace regrasp {

/// A straight link: all points within `radius` of the segment a-b, in W [m].
struct Bone {
  Vector3d a_W = Vector3d::Zero(), b_W = Vector3d::Zero();
  double radius = 0;
};

/// A shape: a capsule as it is, a box as one along its longest side, or where it is flat as two
/// that meet its narrow sides.
using Bones = FixedVector<Bone, 2>;
Bones BonesOf(const Shape& shape, const Isometry3d& X_WL);

/// One finger at some joint angles.
struct FingerPosture {
  FingerVector q;                        ///< root to tip [rad]
  Vector3d p_WF = Vector3d::Zero();      ///< fingertip centre [m]
  Vector3d along_W = Vector3d::UnitZ();  ///< of the tip link, towards the tip
  Bone tip;                              ///< of the fingertip
  Bones body, middle;  ///< the largest other shape of its link, and that of the link before
  FingerJacobian J;    ///< of the fingertip centre
  Isometry3d X_WT = Isometry3d::Identity();  ///< of the tip link
  Isometry3d X_WM = Isometry3d::Identity();  ///< of the link before, where it is not the palm
};

/// All joints between palm and tip link, coupled ones too, root to tip.
using JointChain = FixedVector<int, kMaxLinks>;
JointChain ChainOf(const HandModel& hand, int finger);

/// Forward kinematics of finger `finger` at the angles `q` [rad, root to tip].
FingerPosture PostureAt(const HandModel& hand, int finger, const FingerVector& q);

/// The finger's own angles out of those of the whole hand.
FingerVector AnglesOf(const HandModel& hand, int finger, const JointVector& q);

/// Damped least squares from `from.q` until the fingertip centre is at `p_WF`, joints kept `margin`
/// [rad] inside their limits; `steps` at most. The posture reached; its p_WF tells what is missing.
FingerPosture ReachFor(const HandModel& hand, int finger, const FingerPosture& from,
                       const Vector3d& p_WF, double margin, int steps, const ReachRule& rule = {});

inline constexpr double kTurnStep = 0.06;  ///< of the object, in which MotionReserve() goes [rad]

/// Motion reserve [rad]: how far the object can turn about `axis_W` (unit, sense included) through
/// `p_WO` with this finger following, until one of its joints comes within `margin` [rad] of its
/// limit: q += J⁺ (ω × r) in small steps, with a pull away from the limits in the null space. At
/// most `most`, which is also that of no axis (zero).
double MotionReserve(const HandModel& hand, int finger, const FingerPosture& from,
                     const Vector3d& p_WO, const Vector3d& axis_W, double margin, double most,
                     const ReachRule& rule);

/// Distance between the surfaces of two links; negative where they overlap; 1 m where one of them
/// has no shape (radius 0) [m].
double Gap(const Bone& one, const Bone& two);

}  // namespace regrasp
