#pragma once

/// What the controller is allowed to know: the output of the (noisy) sensors, and nothing else. The
/// libraries of core/control, core/exploration and core/gait see this type and never core/world.

#include <cstdint>

#include "core/common/fields.h"
#include "core/common/fixed_vector.h"
#include "core/common/frames.h"
#include "core/common/limits.h"

namespace regrasp {

struct FingertipReading {
  bool in_contact = false;
  Vector3d p_WC = Vector3d::Zero();  ///< contact position [m]; meaningless without contact
  Vector3d normal_W =
      Vector3d::UnitZ();  ///< outward object normal, unit; meaningless without contact
  double force = 0;       ///< normal force, >= 0 [N]
  template <typename V>
  void Fields(V& v) {
    v("in_contact", in_contact);
    v("p_WC", p_WC);
    v("normal_W", normal_W);
    v("force", force);
  }
};

struct SensorReading {
  std::int64_t tick = 0;
  FixedVector<FingertipReading, kMaxFingers> fingertips;  ///< one per finger of the hand
  JointVector q;                                          ///< joint angles [rad]
  Vector3d p_WO = Vector3d::Zero();                       ///< object position [m]
  Quaterniond q_WO = Quaterniond::Identity();             ///< object orientation
  // What the sensors are, and how old the pose is.
  double object_rate_hz = 0;     ///< the pose comes at this rate; 0: with every reading
  std::int64_t object_tick = 0;  ///< in which the pose was sampled
  double taxel_pitch_m = 0;  ///< > 0: fingertips report taxels this far apart (core/hand/taxels.h)
  template <typename V>
  void Fields(V& v) {
    v("tick", tick);
    v("fingertips", fingertips);
    v("q", q);
    v("p_WO", p_WO);
    v("q_WO", q_WO);
    v("object_rate_hz", object_rate_hz);
    v("object_tick", object_tick, kCountOrNone);
    v("taxel_pitch_m", taxel_pitch_m);
  }
};

}  // namespace regrasp
