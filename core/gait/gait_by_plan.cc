/// The finger gait with landings planned on the felt surface: who may leave, where it lands, and
/// how the others make room for one that may not.
#include <algorithm>
#include <cmath>

#include "core/gait/finger_gait.h"
#include "core/gait/sure_reserve.h"

namespace regrasp {

void FingerGait::StartPlan(int finger, double reach, const ControlTick& tick) {
  LandingPlan::Request request;
  request.finger = finger;
  request.home = HomeOf(finger, tick.gait);
  request.axis_W =
      request_.make_room_for >= 0 ? Vector3d(Vector3d::Zero()) : Vector3d(sign_ * request_.axis_W);
  request.room_for = room_for_;
  request.reach = reach;
  for (std::size_t k = 0; k + 1 < order_.size(); ++k)
    if (order_[k].finger == finger) request.next = order_[k + 1].finger;
  plan_.Start(request);
  Enter(GaitPhase::kPlan);
}

void FingerGait::EndPlan(const ControlTick& tick) {
  const Landing& landing = plan_.landing();
  const int finger = plan_.request().finger;
  const Vector3d p_WC = tick.estimate.p_WO + tick.estimate.q_WO * landing.p_OC;
  const bool makes_room = room_for_ >= 0;
  // To leave is a risk, the larger the scarcer the margin without the finger.
  const double scarce =
      std::clamp(1 - tick.margins.without[finger] / tick.gait.margin_wanted, 0.0, 1.0);
  const double far = (p_WC - tick.finger(finger).p_WC).norm();
  const bool stands = tick.finger(finger).ticks_without_contact == 0;
  const bool gains = far > tick.gait.skip_distance &&
                     landing.gain > tick.gait.worth + tick.gait.worth_scarce * scarce;
  const bool worth =
      !landing.stays &&
      (makes_room ? landing.margin > tick.margins.without[room_for_] + tick.gait.room_gain
                  : !stands || gains);
  Enter(GaitPhase::kChoose);
  const bool blocked = landing.blocked && !landing.stays;
  if ((blocked || (plan_.crowded() && !worth)) && !makes_room && !put_off_.contains(finger)) {
    put_off_.add(finger);  // another may clear the way
    waiting_.add(finger);
    return;
  }
  if (landing.found && worth && !(blocked && stands)) StartRegrasp(tick, finger, landing);
}

void FingerGait::StartRegrasp(const ControlTick& tick, int finger, const Landing& landing) {
  landing_[finger] = landing;
  GaitStep step{finger, GaitObjective::kGaitCriterion};
  int next = -1;
  for (std::size_t k = 0; k < order_.size(); ++k) {
    if (order_[k].finger != finger) continue;
    step = order_[k];
    if (k + 1 < order_.size()) next = order_[k + 1].finger;
  }
  regrasp_.Start(RequestOf(step, next, tick));
  happened_.regrasp_began = true;
  Enter(GaitPhase::kRegrasp);
}

bool FingerGait::Unsteady(const ControlTick& tick) const {
  for (int i : tick.grasp) {
    const FingerEstimate& f = tick.finger(i);
    const bool steady =
        f.ticks_without_contact == 0 && f.ticks_in_contact * tick.dt >= tick.gait.steady_s;
    const bool away = f.ticks_without_contact * tick.dt >= tick.gait.away_s;
    if (!steady && !away) return true;
  }
  return false;
}

double FingerGait::MarginNeeded(const ControlTick& tick, int finger) const {
  if (!planned(tick)) return tick.gait.margin_min;
  // Without progress it is tried with less: the load transfer is careful, and ends in time.
  return caution_[finger] +
         std::max(tick.gait.margin_least, tick.gait.margin_min * std::exp2(-idle_cycles_));
}

double FingerGait::Grip(const ControlTick& tick) const {
  const bool pinch = planned(tick) && finger() >= 0 && order_.back().finger == finger() &&
                     tick.control.friction_estimate >= tick.gait.opposing_friction;
  return pinch ? std::max(tick.gait.grip_force, tick.gait.opposing_grip) : tick.gait.grip_force;
}

bool FingerGait::MayLeave(const ControlTick& tick, int finger) const {
  return PlacesItsTip(tick.hand.fingers[finger]) &&
         tick.margins.without[finger] >= MarginNeeded(tick, finger);
}

void FingerGait::Refuse(const ControlTick& tick, int finger) {
  waiting_.remove(finger);
  refused_finger_ = happened_.refused_finger = finger;
  refused_margin_ = happened_.refused_margin = tick.margins.without[finger];
  refused_below_ = happened_.refused_below = MarginNeeded(tick, finger);
}

void FingerGait::EndStancePlan(const ControlTick& tick) {
  Enter(GaitPhase::kChoose);
  room_for_ = stance_plan_.leaves();
  if (stance_plan_.margin() > stance_plan_.first_margin() + tick.gait.room_gain)
    stance_queue_ = tick.grasp.without(room_for_);
}

/// The finger whose absence leaves the largest load margin; -1 of none.
static int NearestToLeaving(const ControlTick& tick, FingerSet fingers) {
  int nearest = -1;
  for (int i : fingers)
    if (nearest < 0 || tick.margins.without[i] > tick.margins.without[nearest]) nearest = i;
  return nearest;
}

void FingerGait::NextPlanned(const ControlTick& tick, const ObjectWrench& wrench) {
  if (Unsteady(tick) && ticks_ * tick.dt < tick.gait.second_thought_s) return;
  if (room_for_ >= 0) {
    if (MayLeave(tick, room_for_)) {
      room_for_ = -1;
      stance_queue_ = FingerSet();
    } else {
      for (int i : stance_queue_) {
        stance_queue_.remove(i);
        const Landing& landing = stance_plan_.landing(i);
        const Vector3d p_WC = tick.estimate.p_WO + tick.estimate.q_WO * landing.p_OC;
        const bool there = (p_WC - tick.finger(i).p_WC).norm() < tick.gait.skip_distance;
        if (!there && MayLeave(tick, i)) return StartRegrasp(tick, i, landing);
      }
      for (int i : room_queue_) {
        room_queue_.remove(i);
        if (MayLeave(tick, i)) return StartPlan(i, tick.gait.room_reach, tick);
      }
      room_for_ = -1;
    }
  }
  // The margins still remember the finger before in the air.
  const bool early = ticks_ * tick.dt < tick.gait.second_thought_s;
  FingerSet others = waiting_;
  for (int i : put_off_) others.remove(i);
  for (const bool put_off : {false, true}) {
    if (put_off && !others.empty() && early) return;
    for (const GaitStep& step : order_) {
      const int i = step.finger;
      if (put_off_.contains(i) != put_off || !waiting_.contains(i)) continue;
      if (!MayLeave(tick, i)) {
        if (early && let_by_.contains(i)) return;
        continue;
      }
      waiting_.remove(i);
      let_by_.remove(i);
      const double wider = 1 + std::min(1.5, 0.5 * misses_);
      return StartPlan(i, wider * tick.gait.plan_reach, tick);
    }
  }
  if (waiting_.empty()) return EndCycle(tick, wrench);
  if (early) return;
  // Of the fingers that must come along, the one that is nearest to leaving.
  const int refused = NearestToLeaving(tick, waiting_);
  const bool must = ReserveOf(tick, refused) < tick.gait.reserve_needed || idle_cycles_ > 0 ||
                    tick.margins.all < 0.5 * tick.gait.margin_wanted;
  if (must && !made_room_.contains(refused)) {
    made_room_.add(refused);
    room_for_ = refused;
    room_queue_ = tick.grasp.without(refused);
    return;
  }
  if (must && tick.gait.whole_stance && !sought_for_.contains(refused)) {
    sought_for_.add(refused);
    stance_plan_.Start(tick, refused, tick.gait.stance_reach,
                       request_.seed + static_cast<std::uint64_t>(searches_++));
    return Enter(GaitPhase::kStance);
  }
  Refuse(tick, refused);
}

ObjectMotion FingerGait::TurnMeanwhile(const ControlTick& tick, const ObjectWrench& wrench) {
  const GaitParameters& parameters = tick.gait;
  const bool regrasps = phase_ == GaitPhase::kRegrasp && !regrasp_.aborted();
  const bool may = regrasps || phase_ == GaitPhase::kSettle || phase_ == GaitPhase::kChoose ||
                   phase_ == GaitPhase::kPlan;
  const double left = std::abs(request_.angle_rad) - turned_before_;
  // The first round of a gait is at rest: nothing is known of the object yet.
  if (!may || stop_ || !planned(tick) || turned_before_ <= 0 || parameters.along_speed <= 0 ||
      (!request_.continuous && left <= 0)) {
    along_.Stop();
    return {};
  }
  double most = parameters.along_speed;
  if (regrasps && regrasp_.rubs()) most = 0;  // the friction is felt at rest
  if (regrasps && regrasp_.explores()) most = std::min(most, parameters.along_explore_speed);
  if (request_.speed_rad_s > 0) most = std::min(most, request_.speed_rad_s);
  if (!request_.continuous) most = std::min(most, std::sqrt(2 * parameters.acceleration * left));
  const int away = finger();
  const double margin = away >= 0 ? tick.margins.without[away] : tick.margins.all;
  const Vector3d axis_W = sign_ * request_.axis_W;
  const double speed = along_.Update(tick, wrench, tick.grasp.without(away), margin, axis_W, most);
  ObjectMotion per_rad;
  if (parameters.forgive)
    per_rad = forgiveness_.WinBack(parameters, wrench, request_.axis_W, turned_so_far(),
                                   parameters.step_rad);
  turned_before_ += speed * tick.dt;
  turned_meanwhile_ += speed * tick.dt;
  return {speed * per_rad.v_W, speed * (per_rad.w_W + axis_W)};
}

double FingerGait::ReserveOf(const ControlTick& tick, int finger) const {
  const FingerPosture now =
      PostureAt(tick.hand, finger, AnglesOf(tick.hand, finger, tick.estimate.q));
  return SureReserve(tick.hand, finger, now, tick.estimate.p_WO, sign_ * request_.axis_W,
                     tick.gait.limit_margin, tick.gait.reserve_needed, tick.control.reach);
}

}  // namespace regrasp
