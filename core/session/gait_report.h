#pragma once

/// Events and records of a finger gait, judged by the truth.

#include "core/gait/finger_gait.h"
#include "core/session/activity/activity.h"

namespace regrasp {

class GaitReport {
 public:
  /// After each Update of the gait.
  void Report(const FingerGait& gait, const ActivityContext& context);
  template <typename V>
  void Fields(V& v) {
    v("last", last_);
  }

 private:
  void Regrasped(const Regrasp& regrasp, const ActivityContext& context);
  double TruePhi(const Regrasp& regrasp, const ActivityContext& context) const;

  RegraspRecord last_;  // complete once its event has come
};

}  // namespace regrasp
