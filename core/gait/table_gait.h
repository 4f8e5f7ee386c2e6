#pragma once

/// The finger gait by the paper's table alone (Sec. III b; gait_table.h): its fingers regrasp in
/// their order, or the one farthest from its home first (gait.by_need), and come back to their
/// homes. One without which the load margin is below gait.margin_min stays. Where that is the
/// opposing finger, contacts of the others are sought that let it leave (stance_search.h), once a
/// cycle.

#include "core/gait/gait_choice.h"

namespace regrasp {

class TableGait {
 public:
  /// Every finger waits for its turn again.
  void BeginCycle() { sought_ = false; }
  /// The next finger that shall and may leave.
  GaitChoice Next(const ControlTick& tick, const GaitSituation& now, GaitCycle* cycle);
  template <typename V>
  void Fields(V& v) {
    v("sought", sought_);
  }

 private:
  bool sought_ = false;  // another stance, in this cycle
};

}  // namespace regrasp
