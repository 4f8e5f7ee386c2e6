#include "core/control/felt_friction.h"

#include <algorithm>

namespace regrasp {
namespace {

constexpr double kSettled_s = 0.1;  // sliding for so long, the finger has the speed it is asked for
constexpr double kLeastSpeed = 0.002;  // of the contact [m/s]
constexpr double kLeastForce = 0.1;    // [N]
constexpr double kMemory_s = 2.0;      // the mean is over about so much of the last sliding
constexpr double kLeast = 0.1, kMost = 1.0;

}  // namespace

void FeltFriction::Update(const Estimate& estimate, const FingerTasks& tasks,
                          const FixedVector<Vector3d, kMaxFingers>& commanded, double dt) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const FingerEstimate& f = estimate.fingers[i];
    const bool slides = tasks[i].mode == FingerMode::kSlide && f.in_contact &&
                        f.force >= kLeastForce &&
                        TangentPart(tasks[i].v_W, f.normal_W).norm() >= kLeastSpeed;
    sliding_s_[i] = slides ? sliding_s_[i] + dt : 0.0;
    if (sliding_s_[i] < kSettled_s) continue;
    felt_s_ = std::min(kMemory_s, felt_s_ + dt);
    mean_ += dt / felt_s_ * (TangentPart(commanded[i], f.normal_W).norm() / f.force - mean_);
  }
}

double FeltFriction::Counted(double share, double unfelt) const {
  return known() ? std::clamp(share * mean_, kLeast, kMost) : unfelt;
}

}  // namespace regrasp
