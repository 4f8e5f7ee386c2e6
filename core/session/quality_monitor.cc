#include "core/session/quality_monitor.h"

#include <algorithm>
#include <limits>

#include "core/gait/gait_parameters.h"
#include "core/gait/sure_grasp.h"
#include "core/quality/load_margin.h"

namespace regrasp {

void QualityMonitor::Update(const ControlTick& now) {
  const Estimate& estimate = now.estimate;
  const ControlParameters& parameters = now.control;
  const Grasp grasp = GraspOf(estimate, now.grasp, parameters.friction_estimate);
  const double scale = estimate.object_scale;
  MeasureInput input({grasp.data(), grasp.size()}, scale, kEpsilonEdges);
  for (std::size_t i = 0; i < kNumFrameMeasures; ++i)
    if (kMeasureTable[i].cost == MeasureCost::kTick)
      stability_.values[i] = kMeasureTable[i].compute(input);
  stability_.threshold = parameters.stability_threshold;

  if (++tick_ >= std::max(2, Ticks(kMarginInterval, now.dt))) {
    tick_ = 0;
    UpdateMargin(now);
  } else {
    UpdateEpsilon(grasp, scale, now.dt);
  }
  SmoothMargins(now.dt / (parameters.margin_filter_s + now.dt));

  stability_.measure = parameters.stability_measure;
  stability_.active = stability_.of(stability_.measure);
}

StabilityFrame QualityMonitor::stability() const {
  StabilityFrame shown = stability_;
  if (epsilon_known_) return shown;
  double& epsilon = shown.values[static_cast<std::size_t>(Measure::kEpsilon)];
  epsilon = std::numeric_limits<double>::quiet_NaN();
  if (shown.measure == Measure::kEpsilon) shown.active = epsilon;
  return shown;
}

void QualityMonitor::UpdateMargin(const ControlTick& now) {
  const bool whole = turn_ >= now.hand.num_fingers();
  const FingerSet rest = whole ? now.grasp : now.grasp.without(turn_);
  const Grasp grasp = SureGraspOf(now.estimate, rest, now.control.friction_estimate, now.felt,
                                  now.gait.plan ? now.gait.doubt : 0.0);
  const double rho =
      LoadMargin({grasp.data(), grasp.size()}, now.control.mass_estimate * now.gravity_W,
                 now.estimate.object_scale, now.control.max_normal_force);
  (whole ? stability_.load_margin : load_margin_without_[turn_]) = rho;
  turn_ = whole ? 0 : turn_ + 1;
}

void QualityMonitor::SmoothMargins(double gain) {
  margins_.all += gain * (stability_.load_margin - margins_.all);
  for (std::size_t i = 0; i < load_margin_without_.size(); ++i)
    margins_.without[i] += gain * (load_margin_without_[i] - margins_.without[i]);
}

void QualityMonitor::BeginEpsilon() {
  epsilon_.Begin({epsilon_grasp_.data(), epsilon_grasp_.size()}, epsilon_scale_, kEpsilonEdges);
}

void QualityMonitor::RepeatEpsilon() {
  if (!epsilon_begun_) return;
  BeginEpsilon();
  for (int k = 0; k < epsilon_steps_; ++k) epsilon_.Step(kEpsilonFacets);
}

void QualityMonitor::UpdateEpsilon(const Grasp& grasp, double torque_scale, double dt) {
  ++epsilon_ticks_;
  if (!epsilon_begun_) {
    if (epsilon_ticks_ < Ticks(kEpsilonInterval, dt)) return;
    epsilon_grasp_ = grasp;
    epsilon_scale_ = torque_scale;
    epsilon_steps_ = 0;
    epsilon_begun_ = true;
    epsilon_ticks_ = 0;
    BeginEpsilon();
    return;
  }
  ++epsilon_steps_;
  if (!epsilon_.Step(kEpsilonFacets)) return;
  stability_.values[static_cast<std::size_t>(Measure::kEpsilon)] = epsilon_.result();
  epsilon_known_ = true;
  epsilon_begun_ = false;
}

}  // namespace regrasp
