#include "core/control/felt_push.h"

#include <algorithm>

namespace regrasp {

void FeltPush::Update(const Vector3d& p_WO, const Vector3d& v_W,
                      const ControlParameters& parameters, double dt) {
  if (!started_) course_W_ = p_WO;
  started_ = true;
  course_W_ += v_W * dt + dt / (parameters.push_filter_s + dt) * (p_WO - course_W_);
  peak_ = std::max((p_WO - course_W_).norm(), peak_ - dt / parameters.push_memory_s * peak_);
}

double FeltPush::Level(const ControlParameters& parameters) const {
  const double range = std::max(1e-6, parameters.push_full - parameters.push_least);
  return std::clamp((peak_ - parameters.push_least) / range, 0.0, 1.0);
}

}  // namespace regrasp
