#include "core/session/quality_monitor.h"

#include "core/quality/load_margin.h"

namespace regrasp {

void QualityMonitor::Update(const Estimate& estimate, FingerSet fingers, const Vector3d& gravity_W,
                            const ControlParameters& parameters, double dt) {
  const Grasp grasp = GraspOf(estimate, fingers, parameters.friction_estimate);
  const double scale = estimate.object_scale;
  MeasureInput input({grasp.data(), grasp.size()}, scale, kEpsilonEdges);
  for (std::size_t i = 0; i < kNumFrameMeasures; ++i)
    if (kMeasureTable[i].cost == MeasureCost::kTick)
      stability_.values[i] = kMeasureTable[i].compute(input);
  stability_.threshold = parameters.stability_threshold;

  if (++tick_ >= kMarginInterval) {
    tick_ = 0;
    UpdateMargin(estimate, fingers, gravity_W, parameters);
  } else {
    UpdateEpsilon(grasp, scale);
  }
  SmoothMargins(dt / (parameters.margin_filter_s + dt));

  stability_.measure = parameters.stability_measure;
  stability_.active = stability_.of(stability_.measure);
}

void QualityMonitor::UpdateMargin(const Estimate& estimate, FingerSet fingers,
                                  const Vector3d& gravity_W, const ControlParameters& parameters) {
  const Vector3d weight = parameters.mass_estimate * gravity_W;
  const int num_fingers = static_cast<int>(estimate.fingers.size());
  const bool whole = turn_ >= num_fingers;
  const FingerSet rest = whole ? fingers : fingers.without(turn_);
  const Grasp grasp = GraspOf(estimate, rest, parameters.friction_estimate);
  const double rho = LoadMargin({grasp.data(), grasp.size()}, weight, estimate.object_scale,
                                parameters.max_normal_force);
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

void QualityMonitor::UpdateEpsilon(const Grasp& grasp, double torque_scale) {
  ++epsilon_ticks_;
  if (!epsilon_begun_) {
    if (epsilon_ticks_ < kEpsilonInterval) return;
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
  epsilon_begun_ = false;
}

}  // namespace regrasp
