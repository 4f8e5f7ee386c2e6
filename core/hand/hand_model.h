#pragma once

/// The hand as data: links, joints, fingers. Immutable once loaded. Nothing here knows which hand
/// it is or how many fingers it has; `LoadHand` (urdf.h) makes one from files and checks it.

#include <string>
#include <vector>

#include "core/common/frames.h"
#include "core/common/limits.h"

namespace regrasp {

/// Collision shape of a link, in the link frame. A capsule: all points within `radius` of the
/// segment a-b (a == b makes a sphere); or a box.
struct Shape {
  enum class Kind { kCapsule, kBox };
  Kind kind = Kind::kCapsule;
  Vector3d a_L = Vector3d::Zero();           ///< capsule segment start [m]
  Vector3d b_L = Vector3d::Zero();           ///< capsule segment end [m]
  double radius = 0;                         ///< capsule [m]
  Isometry3d X_LB = Isometry3d::Identity();  ///< box centre frame
  Vector3d half_extents = Vector3d::Zero();  ///< box [m]
};

struct Link {
  std::string name;
  int parent_joint = -1;               ///< the joint that moves it; -1 for the palm
  double mass = 0;                     ///< [kg]
  Vector3d p_LCom = Vector3d::Zero();  ///< centre of mass in the link frame [m]
  Matrix3d I_LCom = Matrix3d::Zero();  ///< inertia about the centre of mass, link axes [kg m²]
  std::vector<Shape> shapes;
};

/// A revolute joint. The child link's frame has its origin at the joint: X_PL(q) = X_PJ *
/// Rot(axis_J, q). A coupled joint (driver >= 0) has no drive of its own: an elastic transmission
/// holds it at q = ratio q(driver) + offset, and passes `ratio` times its torque to the driver.
struct Joint {
  std::string name;
  int parent_link = -1;
  int child_link = -1;
  Isometry3d X_PJ = Isometry3d::Identity();  ///< joint frame in the parent link's frame
  Vector3d axis_J = Vector3d::UnitX();       ///< unit axis in the joint frame
  double lower = 0, upper = 0;               ///< limits [rad], lower < upper
  double effort = 0;                         ///< largest torque of the drive [N m]
  double damping = 0;                        ///< viscous damping of joint and gear [N m s/rad]
  double armature = 0;           ///< inertia of the rotor reflected to the joint [kg m²]
  int driver = -1;               ///< coupled: the driven joint it follows
  double ratio = 1, offset = 0;  ///< coupled: of the angle, [] and [rad]
};

/// One finger: a chain from the palm to a tip.
struct Finger {
  std::string name;         ///< as users type it, e.g. "ring"
  std::vector<int> joints;  ///< driven joints that move the tip, root to tip
  int tip_link = -1;        ///< the link that carries the fingertip
  Vector3d p_LF =
      Vector3d::Zero();   ///< centre of the tip's rounding sphere in the tip link's frame [m]
  double tip_radius = 0;  ///< [m]
  int tip_shapes = 1;     ///< the first shapes of the tip link, which feel; the very first has p_LF
};

/// Whether a tip can be put, or slid, where it shall: three driven joints or more move it.
inline bool PlacesItsTip(const Finger& finger) { return finger.joints.size() >= 3; }

/// Of a hand of fewer fingers none can leave an object: the others would not hold it.
inline constexpr int kFewestToRegrasp = 4;

struct HandModel {
  std::string name;
  std::vector<Link> links;  ///< links[0] is the palm, fixed to the world; parents before children
  /// Driven joints (parents before children), then `num_coupled` coupled ones. A JointVector has
  /// one value for each driven joint.
  std::vector<Joint> joints;
  int num_coupled = 0;
  std::vector<Finger> fingers;

  /// Driven joints.
  int num_joints() const { return static_cast<int>(joints.size()) - num_coupled; }
  int num_fingers() const { return static_cast<int>(fingers.size()); }
  /// Index of the finger with this name, or -1.
  int FindFinger(const std::string& finger_name) const {
    for (int i = 0; i < num_fingers(); ++i)
      if (fingers[i].name == finger_name) return i;
    return -1;
  }
};

}  // namespace regrasp
