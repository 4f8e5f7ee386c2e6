#include "core/gait/planned_gait.h"

#include <algorithm>
#include <cmath>

#include "core/gait/gait_parameters.h"
#include "core/gait/sure_reserve.h"

namespace regrasp {
namespace {

using Kind = GaitChoice::Kind;

GaitChoice Only(Kind kind) {
  GaitChoice choice;
  choice.kind = kind;
  return choice;
}

/// A finger has just landed, or lost its contact.
bool Unsteady(const ControlTick& tick) {
  for (int i : tick.grasp) {
    const FingerEstimate& f = tick.finger(i);
    const bool steady =
        f.ticks_without_contact == 0 && f.ticks_in_contact * tick.dt >= tick.gait.steady_s;
    const bool away = f.ticks_without_contact * tick.dt >= tick.gait.away_s;
    if (!steady && !away) return true;
  }
  return false;
}

/// A finger that holds has lost its contact of late.
bool Slips(const ControlTick& tick, FingerSet holds) {
  bool slips = false;
  for (int i : holds) {
    const int ticks = tick.finger(i).ticks_without_contact;
    slips |= ticks * tick.dt >= tick.gait.slip_s && ticks * tick.dt < tick.gait.away_s;
  }
  return slips;
}

/// The finger whose absence leaves the largest load margin; -1 of none.
int NearestToLeaving(const ControlTick& tick, FingerSet fingers) {
  int nearest = -1;
  for (int i : fingers)
    if (nearest < 0 || tick.margins.without[i] > tick.margins.without[nearest]) nearest = i;
  return nearest;
}

/// How far the object can turn before the finger must come along [rad].
double ReserveOf(const ControlTick& tick, int finger, const Vector3d& axis_W) {
  const FingerPosture now =
      PostureAt(tick.hand, finger, AnglesOf(tick.hand, finger, tick.estimate.q));
  return SureReserve(tick.hand, finger, now, tick.estimate.p_WO, axis_W, tick.gait.limit_margin,
                     tick.gait.reserve_needed, tick.control.reach);
}

/// From the finger's contact to the landing [m].
double Distance(const ControlTick& tick, int finger, const Landing& landing) {
  const Vector3d p_WC = tick.estimate.p_WO + tick.estimate.q_WO * landing.p_OC;
  return (p_WC - tick.finger(finger).p_WC).norm();
}

}  // namespace

void PlannedGait::BeginCycle() {
  room_for_ = -1;
  made_room_ = sought_for_ = put_off_ = let_by_ = FingerSet();
}

double PlannedGait::MarginNeeded(const ControlTick& tick, int finger,
                                 const GaitCycle& cycle) const {
  return caution_[finger] +
         std::max(tick.gait.margin_least, tick.gait.margin_min * std::exp2(-cycle.idle));
}

GaitChoice PlannedGait::Next(const ControlTick& tick, const GaitSituation& now, GaitCycle* cycle) {
  // The margins still remember the finger before in the air.
  const bool early = now.since_s < tick.gait.second_thought_s;
  if (Unsteady(tick) && early) return {};
  if (room_for_ >= 0) {
    const GaitChoice choice = NextForRoom(tick, now, *cycle);
    if (choice.kind != Kind::kWait) return choice;
    room_for_ = -1;
  }
  FingerSet others = cycle->waiting;
  for (int i : put_off_) others.remove(i);
  for (const bool put_off : {false, true}) {
    if (put_off && !others.empty() && early) return {};
    for (const GaitStep& step : cycle->order) {
      const int i = step.finger;
      if (put_off_.contains(i) != put_off || !cycle->waiting.contains(i)) continue;
      if (!MayLeaveNow(tick, i, *cycle)) {
        if (early && let_by_.contains(i)) return {};
        continue;
      }
      cycle->waiting.remove(i);
      let_by_.remove(i);
      const double wider = 1 + std::min(1.5, 0.5 * misses_);
      return StartPlan(i, wider * tick.gait.plan_reach, now, *cycle);
    }
  }
  if (cycle->waiting.empty()) {
    GaitChoice choice = Only(Kind::kCycleEnds);
    choice.most_idle = tick.gait.patience;
    choice.most_stale = kStale * tick.gait.patience;
    return choice;
  }
  return early ? GaitChoice() : ForRefused(tick, now, cycle);
}

GaitChoice PlannedGait::NextForRoom(const ControlTick& tick, const GaitSituation& now,
                                    const GaitCycle& cycle) {
  if (MayLeaveNow(tick, room_for_, cycle)) {
    stance_queue_ = FingerSet();
    return {};
  }
  for (int i : stance_queue_) {
    stance_queue_.remove(i);
    const Landing& landing = stance_plan_.landing(i);
    const bool there = Distance(tick, i, landing) < tick.gait.skip_distance;
    if (!there && MayLeaveNow(tick, i, cycle)) return RegraspOf(tick, i, landing);
  }
  for (int i : room_queue_) {
    room_queue_.remove(i);
    if (MayLeaveNow(tick, i, cycle)) return StartPlan(i, tick.gait.room_reach, now, cycle);
  }
  return {};
}

GaitChoice PlannedGait::ForRefused(const ControlTick& tick, const GaitSituation& now,
                                   GaitCycle* cycle) {
  const int refused = NearestToLeaving(tick, cycle->waiting);
  const bool must = ReserveOf(tick, refused, now.axis_W) < tick.gait.reserve_needed ||
                    cycle->idle > 0 || tick.margins.all < 0.5 * tick.gait.margin_wanted;
  if (must && !made_room_.contains(refused)) {
    made_room_.add(refused);
    room_for_ = refused;
    room_queue_ = tick.grasp.without(refused);
    return {};
  }
  if (must && tick.gait.whole_stance && !sought_for_.contains(refused)) {
    sought_for_.add(refused);
    stance_plan_.Start(tick, refused, tick.gait.stance_reach,
                       now.seed + static_cast<std::uint64_t>(cycle->searches++));
    return Only(Kind::kStance);
  }
  cycle->Refuse(tick, refused, MarginNeeded(tick, refused, *cycle));
  GaitChoice choice;
  choice.refuses = true;
  return choice;
}

GaitChoice PlannedGait::StartPlan(int finger, double reach, const GaitSituation& now,
                                  const GaitCycle& cycle) {
  LandingPlan::Request request;
  request.finger = finger;
  request.home = now.homes[finger];
  request.axis_W = now.axis_W;
  request.room_for = room_for_;
  request.reach = reach;
  for (std::size_t k = 0; k + 1 < cycle.order.size(); ++k)
    if (cycle.order[k].finger == finger) request.next = cycle.order[k + 1].finger;
  plan_.Start(request);
  return Only(Kind::kPlan);
}

GaitChoice PlannedGait::Plan(const ControlTick& tick, GaitCycle* cycle) {
  if (!plan_.Step(tick)) return {};
  const Landing& landing = plan_.landing();
  const int finger = plan_.request().finger;
  const bool makes_room = room_for_ >= 0;
  // To leave is a risk, the larger the scarcer the margin without the finger.
  const double scarce =
      std::clamp(1 - tick.margins.without[finger] / tick.gait.margin_wanted, 0.0, 1.0);
  const bool stands = tick.finger(finger).ticks_without_contact == 0;
  const bool gains = Distance(tick, finger, landing) > tick.gait.skip_distance &&
                     landing.gain > tick.gait.worth + tick.gait.worth_scarce * scarce;
  const bool worth =
      !landing.stays &&
      (makes_room ? landing.margin > tick.margins.without[room_for_] + tick.gait.room_gain
                  : !stands || gains);
  const bool blocked = landing.blocked && !landing.stays;
  if ((blocked || (plan_.crowded() && !worth)) && !makes_room && !put_off_.contains(finger)) {
    put_off_.add(finger);  // another may clear the way
    cycle->waiting.add(finger);
    return Only(Kind::kChoose);
  }
  if (landing.found && worth && !(blocked && stands)) return RegraspOf(tick, finger, landing);
  return Only(Kind::kChoose);
}

GaitChoice PlannedGait::PlanStance(const ControlTick& tick) {
  if (!stance_plan_.Step(tick)) return {};
  room_for_ = stance_plan_.leaves();
  if (stance_plan_.margin() > stance_plan_.first_margin() + tick.gait.room_gain)
    stance_queue_ = tick.grasp.without(room_for_);
  return Only(Kind::kChoose);
}

GaitChoice PlannedGait::RegraspOf(const ControlTick& tick, int finger,
                                  const Landing& landing) const {
  GaitChoice choice = Only(Kind::kRegrasp);
  choice.finger = finger;
  choice.planned = true;
  choice.landing = landing;
  const bool scarce = tick.margins.without[finger] < tick.gait.margin_wanted;
  choice.transfer_s = scarce ? tick.gait.careful_s : tick.gait.transfer_s;
  if (!scarce && rubs_ < tick.gait.rubs) choice.rub_s = tick.gait.rub_s;
  return choice;
}

bool PlannedGait::MustBreakOff(const ControlTick& tick, const Regrasp& regrasp,
                               double error_position, double error_rotation) {
  const GaitParameters& parameters = tick.gait;
  const Regrasp::Phase phase = regrasp.phase();
  if (phase == Regrasp::Phase::kUnload && !leaving_) {
    leaving_ = true;
    error_position_ = error_position;
    error_rotation_ = error_rotation;
  }
  if (phase != Regrasp::Phase::kUnload && phase != Regrasp::Phase::kLift &&
      phase != Regrasp::Phase::kSlide)
    return false;
  const double share = parameters.leave_share;
  if (!Slips(tick, tick.grasp.without(regrasp.finger())) &&
      error_position < error_position_ + share * parameters.abort_position &&
      error_rotation < error_rotation_ + share * parameters.abort_rotation)
    return false;
  caution_[regrasp.finger()] += parameters.caution;
  return true;
}

bool PlannedGait::Ended(const ControlTick& tick, const Regrasp& regrasp, GaitCycle* cycle) {
  const int finger = regrasp.finger();
  leaving_ = false;
  if (!regrasp.aborted()) {
    caution_[finger] *= tick.gait.caution_kept;
    if (regrasp.request().rub_s > 0) ++rubs_;
  }
  misses_ = regrasp.no_surface() ? misses_ + 1 : 0;
  if (misses_ >= tick.gait.misses) return false;
  if (regrasp.aborted()) return true;
  if (regrasp.no_surface()) {
    cycle->waiting.add(finger);
  } else {
    let_by_ = put_off_;  // it may have cleared their way
    put_off_ = FingerSet();
  }
  return true;
}

}  // namespace regrasp
