#include "core/control/felt_friction.h"

#include <algorithm>

namespace regrasp {
void FeltFriction::Update(const Estimate& estimate, const FingerTasks& tasks,
                          const FixedVector<Vector3d, kMaxFingers>& commanded,
                          const ControlParameters& parameters, double dt) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const FingerEstimate& f = estimate.fingers[i];
    const bool slides = tasks[i].mode == FingerMode::kSlide && f.in_contact &&
                        f.force >= parameters.feel_force &&
                        TangentPart(tasks[i].v_W, f.normal_W).norm() >= parameters.feel_speed;
    sliding_s_[i] = slides ? sliding_s_[i] + dt : 0.0;
    if (sliding_s_[i] < parameters.feel_settled_s) continue;
    felt_s_ = std::min(parameters.feel_memory_s, felt_s_ + dt);
    mean_ += dt / felt_s_ * (TangentPart(commanded[i], f.normal_W).norm() / f.force - mean_);
  }
}

double FeltFriction::Counted(double share, const ControlParameters& parameters) const {
  constexpr double kMost = 1.0;  // what no pair of dry surfaces is expected to exceed
  return known(parameters) ? std::clamp(share * mean_, parameters.feel_least, kMost)
                           : parameters.friction_estimate;
}

}  // namespace regrasp
