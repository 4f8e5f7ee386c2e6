#pragma once

/// Keeps every quality measure of the present grasp fresh without ever standing in the way of a tick:
/// the cheap ones each tick, one load margin per tick in turn, epsilon a few facets at a time.

#include "core/control/estimate.h"
#include "core/session/frame.h"

namespace regrasp {

class QualityMonitor {
 public:
  QualityMonitor();
  /// `fingers`: bits of the fingers that form the grasp. gravity_W [m/s²].
  void Update(const Estimate& estimate, unsigned fingers, const Vector3d& gravity_W,
              const ControlParameters& parameters);
  const StabilityFrame& stability() const { return stability_; }
  /// rho of the grasp without this finger [N].
  double load_margin_without(int finger) const { return load_margin_without_[finger]; }
  void AddTo(StateHasher* hasher) const;

 private:
  StabilityFrame stability_;
  std::array<double, kMaxFingers> load_margin_without_{};
  int turn_ = 0;
};

}  // namespace regrasp
