#pragma once

/// Limits, effort and damping of a hand's joints: as its file says, or what is taken where it says
/// none. Used only by the hand's loader.

#include <string>
#include <vector>

#include "core/hand/problems.h"
#include "core/hand/urdf.h"
#include "core/hand/urdf_file.h"

namespace regrasp {

class JointValues {
 public:
  /// Both are kept.
  JointValues(const HandLayout& layout, Problems* problems)
      : layout_(layout), problems_(problems) {}

  void Fill(const UrdfJoint& in, Joint* joint);
  /// Warns of what was taken, all joints of a kind in one line.
  void TellDefaults() const;

 private:
  const HandLayout& layout_;
  Problems* problems_;
  std::vector<std::string> undamped_, raised_, unpowered_, slow_;  // names of joints
};

}  // namespace regrasp
