#include "core/gait/table_gait.h"

#include "core/gait/gait_parameters.h"

namespace regrasp {
namespace {

struct Pick {
  int finger = -1;
  double distance = -1;  // from its home [m]
};

/// The first of the table that waits, or the one farthest from its home.
Pick PickOf(const ControlTick& tick, const GaitSituation& now, const GaitCycle& cycle) {
  Pick pick;
  for (const GaitStep& step : cycle.order) {
    const int i = step.finger;
    if (!cycle.waiting.contains(i)) continue;
    const double distance = (now.p_WO + now.homes[i].p_OC_W - tick.finger(i).p_WC).norm();
    if (pick.finger >= 0 && (!tick.gait.by_need || distance <= pick.distance)) continue;
    pick = {i, distance};
  }
  return pick;
}

}  // namespace

GaitChoice TableGait::Next(const ControlTick& tick, const GaitSituation& now, GaitCycle* cycle) {
  const GaitParameters& parameters = tick.gait;
  const bool exploring = parameters.mode == GaitMode::kExploring && !now.makes_room;
  GaitChoice choice;
  while (!cycle->waiting.empty()) {
    const Pick pick = PickOf(tick, now, *cycle);
    if (pick.finger < 0) break;
    if ((!exploring || !now.has_turned) && pick.distance < parameters.skip_distance) {
      cycle->waiting.remove(pick.finger);
      continue;
    }
    if (MayLeave(tick, pick.finger, parameters.margin_min)) {
      cycle->waiting.remove(pick.finger);
      choice.kind = GaitChoice::Kind::kRegrasp;
      choice.finger = pick.finger;
      choice.transfer_s = parameters.transfer_s;
      return choice;
    }
    // The margin still remembers the finger before in the air.
    if (now.since_s < parameters.second_thought_s) return choice;
    cycle->Refuse(tick, pick.finger, parameters.margin_min);
    choice.refuses = true;
  }
  const bool opposing =
      cycle->refused.finger >= 0 && cycle->refused.finger == cycle->order.back().finger;
  if (opposing && !sought_ && !now.makes_room) {
    sought_ = true;
    choice.kind = GaitChoice::Kind::kStance;
    return choice;
  }
  choice.kind = GaitChoice::Kind::kCycleEnds;
  choice.most_idle = parameters.idle_cycles;
  return choice;
}

}  // namespace regrasp
