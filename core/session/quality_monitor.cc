#include "core/session/quality_monitor.h"

#include <algorithm>
#include <limits>

#include "core/gait/gait_parameters.h"
#include "core/gait/sure_grasp.h"
#include "core/quality/load_margin.h"

namespace regrasp {

namespace {

Grasp PresentGrasp(const ControlTick& now) {
  return GraspOf(now.estimate, now.grasp, now.control.friction_estimate);
}

}  // namespace

void QualityMonitor::Update(const ControlTick& now) {
  if (++tick_ >= std::max(2, Ticks(kMarginInterval, now.dt))) {
    tick_ = 0;
    UpdateMargin(now);
  } else {
    UpdateEpsilon(now);
  }
  SmoothMargins(now.dt / (now.control.margin_filter_s + now.dt));
}

StabilityFrame QualityMonitor::stability(const ControlTick& now) const {
  StabilityFrame shown;
  const Grasp grasp = PresentGrasp(now);
  MeasureInput input({grasp.data(), grasp.size()}, now.estimate.object_scale, kEpsilonEdges);
  for (std::size_t i = 0; i < kNumFrameMeasures; ++i)
    if (kMeasureTable[i].cost == MeasureCost::kTick)
      shown.values[i] = kMeasureTable[i].compute(input);
  static_assert(std::ranges::all_of(kMeasureTable, [](const MeasureInfo& m) {
    return m.cost != MeasureCost::kSpread || m.id == Measure::kEpsilon;
  }));  // the solver that is spread over ticks is epsilon's
  shown.values[static_cast<std::size_t>(Measure::kEpsilon)] =
      epsilon_known_ ? epsilon_result_ : std::numeric_limits<double>::quiet_NaN();
  shown.load_margin = load_margin_;
  shown.threshold = now.control.stability_threshold;
  shown.measure = now.control.stability_measure;
  shown.active = shown.of(shown.measure);
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
  (whole ? load_margin_ : load_margin_without_[turn_]) = rho;
  turn_ = whole ? 0 : turn_ + 1;
}

void QualityMonitor::SmoothMargins(double gain) {
  margins_.all += gain * (load_margin_ - margins_.all);
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

void QualityMonitor::UpdateEpsilon(const ControlTick& now) {
  ++epsilon_ticks_;
  if (!epsilon_begun_) {
    if (epsilon_ticks_ < Ticks(kEpsilonInterval, now.dt)) return;
    epsilon_grasp_ = PresentGrasp(now);
    epsilon_scale_ = now.estimate.object_scale;
    epsilon_steps_ = 0;
    epsilon_begun_ = true;
    epsilon_ticks_ = 0;
    BeginEpsilon();
    return;
  }
  ++epsilon_steps_;
  if (!epsilon_.Step(kEpsilonFacets)) return;
  epsilon_result_ = epsilon_.result();
  epsilon_known_ = true;
  epsilon_begun_ = false;
}

}  // namespace regrasp
