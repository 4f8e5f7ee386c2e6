#include "core/gait/finger_gait.h"

#include <algorithm>
#include <cstdio>

#include "core/gait/may_not_leave.h"

namespace regrasp {

std::string_view Name(GaitPhase phase) {
  // In the order of GaitPhase.
  static constexpr std::array<std::string_view, 11> kNames = {
      "idle",    "stance", "object motion", "settle", "choose", "regrasp",
      "recover", "finish", "done",          "failed", "plan"};
  static_assert(kNames.size() == static_cast<std::size_t>(GaitPhase::kPlan) + 1);
  return kNames[static_cast<std::size_t>(phase)];
}

void FingerGait::Start(const Request& request, const ControlTick& tick,
                       const ObjectWrench& wrench) {
  *this = FingerGait();
  request_ = request;
  sign_ = request.angle_rad < 0 ? -1.0 : 1.0;
  cycle_.order = MakeGaitOrder(tick.hand, tick.estimate, tick.grasp);
  home_ = MakeHome(tick.estimate, wrench);
  first_stance_ = home_.stance;
  forgiveness_.Start(wrench);
  Enter(GaitPhase::kStance);
}

void FingerGait::Stop() {
  if (!active()) return;
  stop_ = true;
  if (phase_ == GaitPhase::kObjectMotion) manipulation_.Stop();
  if (phase_ == GaitPhase::kRegrasp) regrasp_.Abort();
}

void FingerGait::Enter(GaitPhase phase) {
  phase_ = phase;
  ticks_ = 0;
  happened_.changed = true;
}

FingerSet FingerGait::Movable(const HandModel& hand, FingerSet fingers) {
  for (int i : fingers)
    if (!PlacesItsTip(hand.fingers[i])) fingers.remove(i);
  return fingers;
}

void FingerGait::BeginCycle(const HandModel& hand) {
  FingerSet all;
  for (const GaitStep& step : cycle_.order) all.add(step.finger);
  cycle_.waiting = Movable(hand, all);
  cycle_.refused = Refusal();
  table_.BeginCycle();
  planned_.BeginCycle();
}

StanceContact FingerGait::HomeOf(int finger, const GaitParameters& parameters) const {
  const double lead = makes_room() ? 0.0 : parameters.lead * parameters.step_rad + lead_[finger];
  const Quaterniond ahead = FromRotationVector(-sign_ * lead * request_.axis_W);
  const StanceContact& first = home_.stance[finger];
  return {ahead * first.p_OC_W, ahead * first.p_OF_W, ahead * first.normal_W};
}

Regrasp::Target FingerGait::TargetOf(int finger, const ObjectWrench& wrench,
                                     const ControlTick& tick) const {
  if (const Landing& landing = landing_; landing.found) {
    const Vector3d& p_WO = tick.estimate.p_WO;
    const Quaterniond& q_WO = tick.estimate.q_WO;
    return {p_WO + q_WO * landing.p_OC,
            p_WO + q_WO * landing.p_OF,
            q_WO * landing.normal_O,
            std::nullopt,
            p_WO,
            along_.speed() * axis_W()};
  }
  const StanceContact home = HomeOf(finger, tick.gait);
  const Vector3d& centre = wrench.p_ref();
  std::optional<Vector3d> recall;
  if (tick.gait.mode == GaitMode::kExploring) {
    const Vector3d shift = regrasp_.request().disc_share * explorations_.found_W(finger);
    recall = centre + Shifted(home, TangentPart(shift, home.normal_W)).p_OC_W;
  }
  return {centre + home.p_OC_W, centre + home.p_OF_W, home.normal_W, recall, centre,
          Vector3d::Zero()};
}

bool FingerGait::Disturbed(const Estimate& estimate, const ObjectWrench& wrench, double position,
                           double rotation) {
  happened_.error_position = (wrench.p_ref() - estimate.p_WO).norm();
  happened_.error_rotation = RotationVector(wrench.q_ref() * estimate.q_WO.conjugate()).norm();
  return happened_.error_position > position || happened_.error_rotation > rotation;
}

GaitSituation FingerGait::Situation(const ControlTick& tick, const ObjectWrench& wrench) const {
  GaitSituation now;
  now.since_s = ticks_ * tick.dt;
  now.makes_room = makes_room();
  now.has_turned = turned_before_ != 0;
  now.axis_W = axis_W();
  now.p_WO = wrench.p_ref();
  now.homes.resize(home_.stance.size());
  for (int i = 0; i < tick.hand.num_fingers(); ++i) now.homes[i] = HomeOf(i, tick.gait);
  now.seed = request_.seed;
  return now;
}

void FingerGait::UpdateChoose(const ControlTick& tick, const ObjectWrench& wrench) {
  const GaitSituation now = Situation(tick, wrench);
  Take(planned(tick) ? planned_.Next(tick, now, &cycle_) : table_.Next(tick, now, &cycle_), tick,
       wrench);
}

void FingerGait::Take(const GaitChoice& choice, const ControlTick& tick,
                      const ObjectWrench& wrench) {
  if (choice.refuses) happened_.refused = cycle_.refused;
  switch (choice.kind) {
    case GaitChoice::Kind::kWait:
      return;
    case GaitChoice::Kind::kChoose:
      return Enter(GaitPhase::kChoose);
    case GaitChoice::Kind::kRegrasp:
      return StartRegrasp(choice, tick);
    case GaitChoice::Kind::kPlan:
      return Enter(GaitPhase::kPlan);
    case GaitChoice::Kind::kStance:
      return Enter(GaitPhase::kStance);
    case GaitChoice::Kind::kCycleEnds:
      return EndCycle(choice, tick, wrench);
  }
}

void FingerGait::StartRegrasp(const GaitChoice& choice, const ControlTick& tick) {
  landing_ = choice.landing;
  const int finger = choice.finger;
  Regrasp::Request request;
  request.slide.finger = finger;
  request.slide.estimator = tick.gait.estimator;
  request.slide.seed = request_.seed + static_cast<std::uint64_t>(regrasps_);
  request.slide.criterion = tick.gait.criterion;
  request.slide.turn_axis_W = axis_W();
  request.slide.gradient_W = explorations_.gradient_W(finger);
  for (std::size_t k = 0; k + 1 < cycle_.order.size(); ++k) {
    const GaitStep& step = cycle_.order[k];
    if (step.finger != finger || step.objective != GaitObjective::kStabilityWithoutNext) continue;
    request.slide.criterion = Criterion::kStability;
    request.slide.without = cycle_.order[k + 1].finger;
  }
  request.hop = tick.gait.hop;
  request.over_surface = choice.planned;
  request.transfer_s = choice.transfer_s;
  request.rub_s = choice.rub_s;
  const bool unknown = choice.planned && landing_.unknown >= tick.gait.explore_unknown;
  request.explore = !makes_room() && explorations_.Explores(tick.gait, finger, unknown);
  request.disc_share = Explorations::DiscShare(tick, opposing());
  regrasp_.Start(request);
  happened_.regrasp_began = true;
  Enter(GaitPhase::kRegrasp);
}

void FingerGait::EndCycle(const GaitChoice& choice, const ControlTick& tick,
                          const ObjectWrench& wrench) {
  if (makes_room()) return Enter(GaitPhase::kFinish);
  if (turned_before_ > 0) ++cycles_;
  if (there()) return Enter(GaitPhase::kFinish);  // while fingers regrasped
  cycle_.idle = turned_before_ - turned_until_ < tick.gait.progress ? cycle_.idle + 1 : 0;
  turned_until_ = turned_before_;
  // Forward what a reference that forgives has given up is no way ahead.
  stale_cycles_ = turned_before_ - turned_most_ < tick.gait.progress ? stale_cycles_ + 1 : 0;
  turned_most_ = std::max(turned_most_, turned_before_);
  const bool stale = stale_cycles_ > choice.most_stale;
  if (!stale && cycle_.idle <= choice.most_idle) return StartMotion(tick, wrench);
  if (stale) {
    std::snprintf(error_, sizeof(error_),
                  "the object cannot turn further: no farther than before in %d cycles",
                  stale_cycles_);
  } else if (const Refusal& refused = cycle_.refused; refused.finger >= 0) {
    const auto text = MayNotLeave(tick.hand, refused.finger, refused.margin, refused.below);
    static_assert(sizeof(text) <= sizeof(error_));
    std::ranges::copy(text, error_);
  } else {
    const int finger = manipulation_.end_finger();
    std::snprintf(error_, sizeof(error_), "the object cannot turn further: %s%s%s",
                  Name(manipulation_.end()).data(), finger >= 0 ? " of " : "",
                  finger >= 0 ? tick.hand.fingers[finger].name.c_str() : "");
  }
  Enter(GaitPhase::kFailed);
}

bool FingerGait::MustBreakOff(const ControlTick& tick, const ObjectWrench& wrench) {
  const GaitParameters& parameters = tick.gait;
  return Disturbed(tick.estimate, wrench, parameters.abort_position, parameters.abort_rotation) ||
         (regrasp_planned() && planned_.MustBreakOff(tick, regrasp_, happened_.error_position,
                                                     happened_.error_rotation));
}

double FingerGait::Grip(const ControlTick& tick) const {
  const bool pinch = finger() >= 0 && finger() == opposing() && regrasp_planned() &&
                     tick.control.friction_estimate >= tick.gait.opposing_friction;
  return pinch ? std::max(tick.gait.grip_force, tick.gait.opposing_grip) : tick.gait.grip_force;
}

void FingerGait::UpdateRegrasp(const ControlTick& tick, HybridController* controller,
                               FingerTasks* tasks) {
  const ObjectWrench& wrench = controller->wrench();
  if (!regrasp_.aborted() && MustBreakOff(tick, wrench)) {
    regrasp_.Abort();
    happened_.aborted = true;
  }
  const Regrasp::Phase before = regrasp_.phase();
  const int finger = regrasp_.finger();
  regrasp_.Update(tick, TargetOf(finger, wrench, tick), controller, tasks);
  happened_.changed |= regrasp_.phase() != before;
  happened_.explore_began = regrasp_.slide().slide_began();
  happened_.explore_ended = regrasp_.slide().slide_ended();
  if (happened_.explore_ended)
    explorations_.Add(tick.gait, regrasp_.slide(),
                      tick.finger(finger).p_WC - wrench.p_ref() - HomeOf(finger, tick.gait).p_OC_W);
  if (regrasp_.active()) return;
  happened_.regrasp_ended = true;
  const bool goes_on =
      regrasp_planned() ? planned_.Ended(tick, regrasp_, &cycle_) : !regrasp_.no_surface();
  if (!goes_on) {
    std::snprintf(error_, sizeof(error_), "%s found no surface to stand on",
                  tick.hand.fingers[finger].name.c_str());
    Enter(GaitPhase::kFailed);
  } else if (stop_) {
    Enter(GaitPhase::kFinish);
  } else if (regrasp_.aborted()) {
    Enter(GaitPhase::kRecover);
  } else {
    ++regrasps_;
    Enter(GaitPhase::kChoose);
  }
}

void FingerGait::UpdateRecover(const ControlTick& tick, ObjectWrench* wrench) {
  const GaitParameters& parameters = tick.gait;
  const double held_s = ticks_ * tick.dt;
  forgiveness_.Watch(tick, held_s);
  if (held_s <= parameters.recover_limit_s &&
      Disturbed(tick.estimate, *wrench, parameters.recovered * parameters.abort_position,
                parameters.recovered * parameters.abort_rotation))
    return;
  Forgive(tick, true, wrench);
  Enter(there() ? GaitPhase::kFinish : GaitPhase::kChoose);
}

bool FingerGait::Rests(const ControlTick& tick, const ObjectWrench& wrench) {
  constexpr double kTurnedShare = 0.2;  // of the abort limit: what may be missing of the rotation
  const GaitParameters& parameters = tick.gait;
  const double rested_s = ticks_ * tick.dt;
  if (stop_) return true;
  if (rested_s < parameters.finish_s) return false;
  return rested_s >= parameters.recover_limit_s ||
         !Disturbed(tick.estimate, wrench, parameters.recovered * parameters.abort_position,
                    kTurnedShare * parameters.abort_rotation);
}

bool FingerGait::SearchStance(const ControlTick& tick) {
  const ControlParameters& control = tick.control;
  if (ticks_ == 1) {
    const int leaves = makes_room() ? request_.make_room_for : opposing();
    margin_wanted_ = std::max(tick.gait.margin_wanted, tick.gait.want_more * margin_wanted_);
    search_.Start(first_stance_, home_.stance, tick.grasp, leaves, tick.gait.max_shift,
                  request_.seed + static_cast<std::uint64_t>(cycle_.searches++));
  }
  if (ticks_ % Ticks(tick.gait.search_interval_s, tick.dt) == 0)
    search_.Step(control.mass_estimate * tick.gravity_W, control.friction_estimate,
                 tick.estimate.object_scale, control.max_normal_force, tick.gait.search_step);
  return search_.margin() >= margin_wanted_ || search_.evaluations() >= tick.gait.search_trials;
}

void FingerGait::UpdateStance(const ControlTick& tick, const ObjectWrench& wrench) {
  if (planned_.plans_stance()) return Take(planned_.PlanStance(tick), tick, wrench);
  if (!SearchStance(tick)) return;
  home_.stance = search_.stance();
  cycle_.waiting = Movable(tick.hand, tick.grasp.without(request_.make_room_for));
  Enter(GaitPhase::kChoose);
}

ObjectMotion FingerGait::Update(const ControlTick& tick, HybridController* controller,
                                FingerTasks* tasks) {
  happened_ = Happened();
  ObjectMotion motion;
  if (!active()) return motion;
  ++ticks_;
  for (int i : tick.grasp.without(finger())) {
    FingerTask& task = (*tasks)[i];
    task.mode = FingerMode::kHold;
    task.cap = tick.control.max_normal_force;
    task.grip = Grip(tick);
  }
  ObjectWrench& wrench = controller->wrench();
  const bool busy = phase_ == GaitPhase::kObjectMotion || phase_ == GaitPhase::kRegrasp ||
                    phase_ == GaitPhase::kFinish;
  if (stop_ && !busy) {
    Enter(GaitPhase::kFinish);
    return motion;
  }

  switch (phase_) {
    case GaitPhase::kStance:
      UpdateStance(tick, wrench);
      break;
    case GaitPhase::kObjectMotion:
      motion = UpdateMotion(tick, &wrench);
      break;
    case GaitPhase::kSettle:
      if (ticks_ * tick.dt >= tick.gait.settle_s) Enter(GaitPhase::kChoose);
      break;
    case GaitPhase::kChoose:
      UpdateChoose(tick, wrench);
      break;
    case GaitPhase::kPlan:
      Take(planned_.Plan(tick, &cycle_), tick, wrench);
      break;
    case GaitPhase::kRegrasp:
      UpdateRegrasp(tick, controller, tasks);
      break;
    case GaitPhase::kRecover:
      UpdateRecover(tick, &wrench);
      break;
    case GaitPhase::kFinish:
      if (Rests(tick, wrench)) Enter(GaitPhase::kDone);
      break;
    case GaitPhase::kIdle:
    case GaitPhase::kDone:
    case GaitPhase::kFailed:
      break;
  }
  return motion.w_W.isZero(0) ? TurnMeanwhile(tick, wrench) : motion;
}

}  // namespace regrasp
