#pragma once

/// The finger gait of the paper (Sec. III b) as a table.

#include <array>
#include <string_view>

#include "core/control/estimate.h"
#include "core/hand/hand_model.h"

namespace regrasp {

/// What the free finger maximises while it regrasps.
enum class GaitObjective : std::uint8_t {
  kNone,
  kManipulability,       ///< of the free finger; stability once that is below its threshold
  kStabilityWithoutNext  ///< stability of the grasp without the next finger of the table
};

struct GaitRow {
  std::string_view state;   ///< the paper's name
  std::string_view finger;  ///< that is free; empty: all fingers hold
  GaitObjective objective;
};

/// One cycle of the gait, top to bottom, again and again. All other fingers hold.
inline constexpr std::array<GaitRow, 6> kGaitTable{{
    // state          free finger   objective
    {"object motion", "", GaitObjective::kNone},
    {"S_L", "little", GaitObjective::kManipulability},
    {"S_R", "ring", GaitObjective::kManipulability},
    {"S_M", "middle", GaitObjective::kManipulability},
    {"S_F", "first", GaitObjective::kStabilityWithoutNext},
    {"S_T", "thumb", GaitObjective::kManipulability},
}};

/// The finger whose contact normal points most against the sum of the others': the one without
/// which the others can hold least. -1 with fewer than two touching fingers of `fingers`.
int OpposingFinger(const Estimate& estimate, FingerSet fingers);

/// One step of a gait made for a hand.
struct GaitStep {
  int finger = -1;
  GaitObjective objective = GaitObjective::kManipulability;
  template <typename V>
  void Fields(V& v) {
    v("finger", finger, v.Finger());
    v("objective", objective, GaitObjective::kStabilityWithoutNext);
  }
};
using GaitOrder = FixedVector<GaitStep, kMaxFingers>;

/// The table for this hand: its rows whose finger the hand has, then the hand's other fingers, then
/// the opposing finger, which is always last; the finger before it maximises stability without it.
/// Only fingers of `fingers`.
GaitOrder MakeGaitOrder(const HandModel& hand, const Estimate& estimate, FingerSet fingers);

}  // namespace regrasp
