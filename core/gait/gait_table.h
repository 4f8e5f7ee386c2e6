#pragma once

/// The finger gait of the paper (Sec. III b) as a table, by the fingers' roles in the grasp, so
/// that every hand has one. The five-fingered hand's states are the paper's: S_L, S_R, S_M, S_F,
/// S_T.

#include <array>
#include <string_view>

#include "core/control/control_tick.h"

namespace regrasp {

/// Which Criterion the free finger maximises while it regrasps and explores, and of which grasp.
enum class GaitObjective : std::uint8_t {
  kNone,
  /// gait.criterion, of the grasp; by default `switched`: manipulability of the free finger, or
  /// stability once that is below its threshold.
  kGaitCriterion,
  kStabilityWithoutNext  ///< stability of the grasp without the next finger of the table
};

/// Which finger is free. The opposing finger is the one without which the others can hold least
/// (OpposingFinger); its neighbours are the others, in order: the farthest from its knuckle first.
enum class GaitRole : std::uint8_t {
  kNobody,         ///< all fingers hold
  kNeighbours,     ///< all neighbours but the last, one after the other
  kLastNeighbour,  ///< the one next to the opposing finger
  kOpposing,
};

struct GaitRow {
  GaitRole free;
  GaitObjective objective;
};

/// One cycle of the gait, top to bottom, again and again. All other fingers hold.
inline constexpr std::array<GaitRow, 4> kGaitTable{{
    // free finger               objective                              the paper's states
    {GaitRole::kNobody, GaitObjective::kNone},                         // object motion
    {GaitRole::kNeighbours, GaitObjective::kGaitCriterion},            // S_L, S_R, S_M
    {GaitRole::kLastNeighbour, GaitObjective::kStabilityWithoutNext},  // S_F
    {GaitRole::kOpposing, GaitObjective::kGaitCriterion},              // S_T
}};

/// The name of a state of the gait.
struct GaitStateName {
  std::array<char, 24> text{};  ///< ends with 0
  std::string_view view() const { return text.data(); }
};
/// The state in which this finger is free, "S_" and its initial: S_T for the thumb. Where two
/// fingers of the hand begin alike, "S_" and its name, shortened to 21 letters. -1: "object
/// motion".
GaitStateName GaitStateNameOf(const HandModel& hand, int finger);

/// The finger whose contact normal points most against the sum of the others': the one without
/// which the others can hold least. -1 with fewer than two touching fingers of `fingers`.
int OpposingFinger(const Estimate& estimate, FingerSet fingers);

/// One step of a gait made for a hand: a row, with its finger.
struct GaitStep {
  int finger = -1;
  GaitObjective objective = GaitObjective::kGaitCriterion;
  template <typename V>
  void Fields(V& v) {
    v("finger", finger, v.Finger());
    v("objective", objective, GaitObjective::kStabilityWithoutNext);
  }
};
using GaitOrder = FixedVector<GaitStep, kMaxFingers>;

/// The table for this grasp: its rows in order with their fingers, without the row of object
/// motion. Without an opposing finger the only one is a neighbour. Only fingers of `fingers`.
GaitOrder MakeGaitOrder(const HandModel& hand, const Estimate& estimate, FingerSet fingers);

}  // namespace regrasp
