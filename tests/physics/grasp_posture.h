#pragma once

/// A fixed grasp of the Shadow Hand for tests and benchmarks of the world, independent of the
/// scenario's preshape: all five fingers touch a sphere of 5 cm diameter, links at least 3 mm
/// apart.

#include <map>
#include <numbers>
#include <string>

#include "core/common/frames.h"
#include "core/common/limits.h"
#include "core/hand/hand_model.h"

namespace regrasp {

/// Joint angles [rad]. Throws std::out_of_range for a hand with other joints.
inline JointVector GraspPosture(const HandModel& hand) {
  static const std::map<std::string, double> degrees = {
      {"FFJ4", -8.51}, {"FFJ3", 12.01}, {"FFJ2", 78.84}, {"FFJ1", 35.73}, {"MFJ4", -12.48},
      {"MFJ3", 5.57},  {"MFJ2", 79.82}, {"MFJ1", 41.56}, {"RFJ4", 15.16}, {"RFJ3", 8.69},
      {"RFJ2", 79.45}, {"RFJ1", 29.75}, {"LFJ5", 39.74}, {"LFJ4", -1.27}, {"LFJ3", -2.20},
      {"LFJ2", 25.79}, {"LFJ1", 78.75}, {"THJ5", 8.14},  {"THJ4", 62.62}, {"THJ3", 9.03},
      {"THJ2", 22.12}, {"THJ1", 48.50}};
  JointVector q(hand.num_joints());
  for (int i = 0; i < hand.num_joints(); ++i)
    q[i] = degrees.at(hand.joints[i].name) * std::numbers::pi / 180;
  return q;
}

/// Where the sphere is in that grasp.
inline Isometry3d GraspObjectPose() {
  Isometry3d X_WO = Isometry3d::Identity();
  X_WO.translation() = Vector3d(0.01612, -0.06371, 0.10808);
  return X_WO;
}

/// Gravity with the palm tilted by 65 degrees [m/s²].
inline Vector3d GraspGravity() { return Vector3d(0, 4.145885, 8.890879); }

}  // namespace regrasp
