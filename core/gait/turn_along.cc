#include "core/gait/turn_along.h"

#include <algorithm>

#include "core/gait/gait_parameters.h"
#include "core/gait/sure_reserve.h"

namespace regrasp {

double TurnAlong::Update(const ControlTick& tick, const ObjectWrench& wrench, FingerSet holds,
                         double margin, const Vector3d& axis_W, double most) {
  const GaitParameters& parameters = tick.gait;
  const Estimate& estimate = tick.estimate;
  next_ = (next_ + 1) % tick.hand.num_fingers();
  if (tick.grasp.contains(next_)) {
    const FingerPosture now = PostureAt(tick.hand, next_, AnglesOf(tick.hand, next_, estimate.q));
    reserve_[next_] =
        SureReserve(tick.hand, next_, now, estimate.p_WO, axis_W, parameters.limit_margin,
                    parameters.along_speed * parameters.along_ahead_s, tick.control.reach);
  }
  double wanted = most;
  for (int i : holds) wanted = std::min(wanted, reserve_[i] / parameters.along_ahead_s);
  const double spare = std::max(1e-3, parameters.along_margin - parameters.margin_min);
  wanted *= std::clamp((margin - parameters.margin_min) / spare, 0.0, 1.0);
  const double behind = (wrench.p_ref() - estimate.p_WO).norm();
  const double turned_behind = RotationVector(wrench.q_ref() * estimate.q_WO.conjugate()).norm();
  if (behind > parameters.lag_position || turned_behind > parameters.lag_rotation) wanted = 0;
  const double change = parameters.acceleration * tick.dt;
  speed_ = std::max(0.0, std::clamp(wanted, speed_ - change, speed_ + change));
  return speed_;
}

}  // namespace regrasp
