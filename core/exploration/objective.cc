#include "core/exploration/objective.h"

#include <algorithm>
#include <cassert>

#include "core/hand/finger_reach.h"
#include "core/quality/measures.h"

namespace regrasp {
double GraspStability(const Estimate& estimate, FingerSet fingers,
                      const ControlParameters& parameters) {
  const Grasp grasp = GraspOf(estimate, fingers, parameters.friction_estimate);
  MeasureInput input({grasp.data(), grasp.size()}, estimate.object_scale, kMonitorEdges);
  const MeasureInfo& measure = InfoOf(parameters.stability_measure);
  assert(measure.cost == MeasureCost::kTick);
  return measure.compute(input);
}

namespace {

double Reserve(const HandModel& hand, const ObjectiveOf& of, const Estimate& estimate,
               const ReachRule& reach, const ExplorationParameters& exploration) {
  const FingerPosture now = PostureAt(hand, of.finger, AnglesOf(hand, of.finger, estimate.q));
  const double reserve = MotionReserve(hand, of.finger, now, estimate.p_WO, of.turn_axis_W,
                                       exploration.limit_margin, kMostReserve, reach);
  const double missing = std::max(0.0, exploration.reserve_margin_wanted - of.margin);
  return reserve + exploration.reserve_manipulability * estimate.fingers[of.finger].manipulability -
         exploration.reserve_margin_cost * missing;
}

}  // namespace

ObjectiveValue Objective(const HandModel& hand, const ObjectiveOf& of, const Estimate& estimate,
                         const ControlParameters& control, const ExplorationParameters& exploration,
                         bool was_on_stability) {
  const double manipulability = estimate.fingers[of.finger].manipulability;
  const double stability =
      InfoOf(of.criterion).takes_stability ? GraspStability(estimate, of.fingers, control) : 0;
  switch (of.criterion) {
    case Criterion::kManipulability:
      return {manipulability, false};
    case Criterion::kStability:
      return {stability, true};
    case Criterion::kSwitched: {
      const double threshold =
          control.stability_threshold * (was_on_stability ? control.stability_hysteresis : 1.0);
      const bool on_stability = stability < threshold;
      return {on_stability ? stability : manipulability, on_stability};
    }
    case Criterion::kCombined:
      return {manipulability + exploration.stability_weight * stability, false};
    case Criterion::kReserve:
      return {Reserve(hand, of, estimate, control.reach, exploration), false};
  }
  return {};
}

}  // namespace regrasp
