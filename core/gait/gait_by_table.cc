/// The finger gait by the paper's table alone: who regrasps next and what for, and contacts that
/// let the opposing finger leave.
#include <algorithm>

#include "core/gait/finger_gait.h"

namespace regrasp {

void FingerGait::SearchStance(const ControlTick& tick) {
  const ControlParameters& control = tick.control;
  if (ticks_ == 1) {
    const int opposing = order_.empty() ? -1 : order_.back().finger;
    const int leaves = request_.make_room_for >= 0 ? request_.make_room_for : opposing;
    margin_wanted_ = std::max(tick.gait.margin_wanted, tick.gait.want_more * margin_wanted_);
    search_.Start(first_stance_, home_.stance, tick.grasp, leaves, tick.gait.max_shift,
                  request_.seed + static_cast<std::uint64_t>(searches_++));
  }
  if (ticks_ % Ticks(tick.gait.search_interval_s, tick.dt) == 0)
    search_.Step(control.mass_estimate * tick.gravity_W, control.friction_estimate,
                 tick.estimate.object_scale, control.max_normal_force, tick.gait.search_step);
  if (search_.margin() < margin_wanted_ && search_.evaluations() < tick.gait.search_trials) return;
  home_.stance = search_.stance();
  waiting_ = Movable(tick.hand, tick.grasp.without(request_.make_room_for));
  Enter(GaitPhase::kChoose);
}

void FingerGait::Remember(int finger, const ControlTick& tick, const ObjectWrench& wrench) {
  const Vector3d shift =
      tick.finger(finger).p_WC - wrench.p_ref() - HomeOf(finger, tick.gait).p_OC_W;
  Vector3d& found = found_[finger];
  found += tick.gait.found_share * (shift - found);
  found = LimitNorm(found, tick.gait.disc_inside * tick.gait.disc_radius);
  const GuidedSlide& slide = regrasp_.slide();
  gradient_[finger] = slide.algorithm().gradient_W();
  gain_[finger].Add(RelativeGain(slide.phi_final(), slide.phi_initial()), tick.gait.found_share);
}

bool FingerGait::Explores(const ControlTick& tick, int finger) const {
  const GaitParameters& parameters = tick.gait;
  if (parameters.mode != GaitMode::kExploring || request_.make_room_for >= 0 ||
      parameters.explore == GaitExplore::kNever)
    return false;
  return parameters.explore == GaitExplore::kAlways ||
         gain_[finger].at_least(parameters.explore_gain) ||
         (planned(tick) && landing_[finger].unknown >= parameters.explore_unknown);
}

double FingerGait::DiscShare(const ControlTick& tick) const {
  if (order_.empty()) return 1;
  const GaitParameters& parameters = tick.gait;
  const double margin = tick.margins.without[order_.back().finger] - parameters.margin_min;
  const double wanted = tick.gait.disc_full * parameters.margin_wanted - parameters.margin_min;
  return wanted > 0 ? std::clamp(margin / wanted, 0.0, 1.0) : 1.0;
}

Regrasp::Request FingerGait::RequestOf(const GaitStep& step, int next,
                                       const ControlTick& tick) const {
  Regrasp::Request request;
  request.slide.finger = step.finger;
  request.slide.estimator = tick.gait.estimator;
  request.hop = tick.gait.hop;
  request.over_surface = planned(tick);
  const bool scarce = planned(tick) && tick.margins.without[step.finger] < tick.gait.margin_wanted;
  request.transfer_s = scarce ? tick.gait.careful_s : tick.gait.transfer_s;
  if (planned(tick) && !scarce && rubs_ < tick.gait.rubs) request.rub_s = tick.gait.rub_s;
  request.explore = Explores(tick, step.finger);
  request.slide.seed = request_.seed + static_cast<std::uint64_t>(regrasps_);
  request.slide.criterion = tick.gait.criterion;
  request.slide.turn_axis_W = sign_ * request_.axis_W;
  if (step.objective == GaitObjective::kStabilityWithoutNext && next >= 0) {
    request.slide.criterion = Criterion::kStability;
    request.slide.without = next;
  }
  request.slide.gradient_W = gradient_[step.finger];
  request.disc_share = DiscShare(tick);
  return request;
}

void FingerGait::Next(const ControlTick& tick, const ObjectWrench& wrench) {
  const GaitParameters& parameters = tick.gait;
  const bool exploring = parameters.mode == GaitMode::kExploring && request_.make_room_for < 0;
  while (!waiting_.empty()) {
    // The first of the table that waits, or the one farthest from its target.
    int pick = -1;
    double farthest = -1;
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const int i = order_[k].finger;
      if (!waiting_.contains(i)) continue;
      const double distance = (TargetOf(i, wrench, tick).p_WC - tick.finger(i).p_WC).norm();
      if (pick >= 0 && (!parameters.by_need || distance <= farthest)) continue;
      pick = static_cast<int>(k);
      farthest = distance;
    }
    if (pick < 0) break;
    const GaitStep& step = order_[pick];
    if ((!exploring || turned_before_ == 0) && farthest < parameters.skip_distance) {
      waiting_.remove(step.finger);
      continue;
    }
    const bool refused = !MayLeave(tick, step.finger);
    // The margin still remembers the finger before in the air.
    if (refused && ticks_ * tick.dt < tick.gait.second_thought_s) return;
    waiting_.remove(step.finger);
    if (refused) {
      Refuse(tick, step.finger);
      continue;
    }
    const int next = pick + 1 < static_cast<int>(order_.size()) ? order_[pick + 1].finger : -1;
    regrasp_.Start(RequestOf(step, next, tick));
    happened_.regrasp_began = true;
    Enter(GaitPhase::kRegrasp);
    return;
  }
  EndCycle(tick, wrench);
}

}  // namespace regrasp
