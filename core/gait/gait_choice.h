#pragma once

/// How the finger gait (finger_gait.h) asks which finger regrasps next and where it lands. One of
/// two gaits answers: the paper's table (table_gait.h) or the plan (planned_gait.h). It is asked
/// in every tick of the phase "choose", with a GaitSituation; both take fingers off the waiting
/// ones of the GaitCycle; the answer is a GaitChoice, which FingerGait carries out.

#include <limits>

#include "core/gait/gait_table.h"
#include "core/gait/landing_plan.h"
#include "core/gait/may_not_leave.h"
#include "core/gait/stance.h"

namespace regrasp {

/// What lasts from one choice to the next. FingerGait keeps it.
struct GaitCycle {
  GaitOrder order;    ///< the fingers of the table, the opposing one last
  FingerSet waiting;  ///< those that have not had their turn in this cycle
  Refusal refused;    ///< the last one of this cycle
  int idle = 0;       ///< so many cycles in a row have not turned the object
  int searches = 0;   ///< for a stance, so far: each has a seed of its own

  /// The finger has its turn without leaving; what it lacked is kept for the report.
  void Refuse(const ControlTick& tick, int finger, double needed) {
    waiting.remove(finger);
    refused = {finger, tick.margins.without[finger], needed};
  }
  template <typename V>
  void Fields(V& v) {
    v("order", order);
    v("waiting", waiting);
    v("refused", refused);
    v("idle", idle);
    v("searches", searches);
  }
};

/// What a choice is made by, beside the tick; valid during that tick.
struct GaitSituation {
  double since_s = 0;       ///< so long the gait has been choosing [s]
  bool makes_room = false;  ///< no rotation: the others shift until one finger may leave (S_F)
  bool has_turned = false;  ///< the object has, in this rotation
  Vector3d axis_W = Vector3d::UnitZ();  ///< unit, of the turn, sense included
  Vector3d p_WO = Vector3d::Zero();     ///< the object's reference [m]
  Stance homes;                         ///< where each finger comes back to, about p_WO
  std::uint64_t seed = 0;               ///< of the rotation
};

/// What comes next.
struct GaitChoice {
  enum class Kind : std::uint8_t {
    kWait,       ///< asked again in the next tick
    kChoose,     ///< a plan is made: a finger is chosen anew
    kRegrasp,    ///< `finger` regrasps
    kPlan,       ///< the gait plans where a finger lands
    kStance,     ///< contacts are sought from which a refused finger may leave
    kCycleEnds,  ///< every finger has had its turn
  };
  Kind kind = Kind::kWait;
  bool refuses = false;  ///< GaitCycle::refused is of this tick

  // kRegrasp.
  int finger = -1;
  bool planned = false;   ///< it lands where the plan has it, over the felt surface
  Landing landing;        ///< ... there; at its home where none is found or planned
  double transfer_s = 0;  ///< load transfer before it leaves [s]
  double rub_s = 0;       ///< slides so long before it hops, to feel the friction [s]

  // kCycleEnds: the gait gives up after more cycles in a row than
  int most_idle = 0;                                 ///< these, that have not turned the object
  int most_stale = std::numeric_limits<int>::max();  ///< ... no farther than ever before
};

}  // namespace regrasp
