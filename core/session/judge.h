#pragma once

/// What the truth says: noise-free readings in the controller's own terms. For job records and
/// events only; the controller never sees it.

#include "core/control/estimate.h"
#include "core/exploration/objective.h"
#include "core/sensing/sensors.h"
#include "core/session/parameters.h"

namespace regrasp {

class Judge {
 public:
  Judge(const HandModel& hand, double dt)
      : hand_(&hand), sensors_(hand, dt, 0), estimator_(hand, dt) {}

  /// Takes the truth after the last step in. `tick` never decreases.
  void Look(std::int64_t tick, const WorldState& truth, const ControlParameters& parameters);
  const Estimate& estimate() const { return estimator_.estimate(); }
  /// What exploration maximises, by the truth last looked at; of.margin is found here.
  double Phi(ObjectiveOf of, const Parameters& parameters, bool on_stability) const;
  template <typename V>
  void Fields(V& v) {
    v("sensors", sensors_);
    v("estimator", estimator_);
  }

 private:
  const HandModel* hand_;
  Sensors sensors_;  // without noise
  StateEstimator estimator_;
};

}  // namespace regrasp
