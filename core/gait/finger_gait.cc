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
  order_ = MakeGaitOrder(tick.hand, tick.estimate, tick.grasp);
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

void FingerGait::StartMotion(const ControlTick& tick, const ObjectWrench& wrench) {
  const GaitParameters& parameters = tick.gait;
  const double left = std::abs(request_.angle_rad) - turned_before_;
  const double due = std::max(0.0, parameters.step_rad - turned_meanwhile_);
  const double step = request_.continuous ? due : std::min(due, left);
  const bool went_on = turned_meanwhile_ > 0;
  turned_meanwhile_ = 0;
  if (went_on && step < parameters.progress && step < left) {
    BeginCycle(tick.hand);
    return Enter(GaitPhase::kChoose);
  }
  const double speed = request_.speed_rad_s > 0 ? request_.speed_rad_s : parameters.speed_rad_s;
  ObjectMotion per_rad;
  if (parameters.forgive && step > 0.5 * parameters.step_rad)
    per_rad = forgiveness_.WinBack(parameters, wrench, request_.axis_W, turned_so_far(), step);
  per_rad.w_W += sign_ * request_.axis_W;
  manipulation_.Start(per_rad, step, speed, parameters.acceleration,
                      LocalManipulation::AtLimit::kEnds);
  Enter(GaitPhase::kObjectMotion);
}

void FingerGait::EndMotion(const ControlTick& tick) {
  turned_before_ += manipulation_.travelled();
  if (const int finger = manipulation_.end_finger(); finger >= 0) {
    double& lead = lead_[finger];
    const double missing = manipulation_.length() - manipulation_.travelled();
    lead = std::min(tick.gait.lead_max, lead + 0.5 * missing);
  }
  BeginCycle(tick.hand);
}

FingerSet FingerGait::Movable(const HandModel& hand, FingerSet fingers) {
  for (int i : fingers)
    if (!PlacesItsTip(hand.fingers[i])) fingers.remove(i);
  return fingers;
}

void FingerGait::BeginCycle(const HandModel& hand) {
  FingerSet all;
  for (const GaitStep& step : order_) all.add(step.finger);
  waiting_ = Movable(hand, all);
  refused_finger_ = -1;
  sought_ = false;
  room_for_ = -1;
  made_room_ = sought_for_ = put_off_ = let_by_ = FingerSet();
}

StanceContact FingerGait::HomeOf(int finger, const GaitParameters& parameters) const {
  const double lead =
      request_.make_room_for >= 0 ? 0.0 : parameters.lead * parameters.step_rad + lead_[finger];
  const Quaterniond ahead = FromRotationVector(-sign_ * lead * request_.axis_W);
  const StanceContact& first = home_.stance[finger];
  return {ahead * first.p_OC_W, ahead * first.p_OF_W, ahead * first.normal_W};
}

Regrasp::Target FingerGait::TargetOf(int finger, const ObjectWrench& wrench,
                                     const ControlTick& tick) const {
  if (planned(tick) && landing_[finger].found) {
    const Landing& landing = landing_[finger];
    const Vector3d& p_WO = tick.estimate.p_WO;
    const Quaterniond& q_WO = tick.estimate.q_WO;
    return {p_WO + q_WO * landing.p_OC,
            p_WO + q_WO * landing.p_OF,
            q_WO * landing.normal_O,
            std::nullopt,
            p_WO,
            along_.speed() * sign_ * request_.axis_W};
  }
  const StanceContact home = HomeOf(finger, tick.gait);
  const Vector3d& centre = wrench.p_ref();
  std::optional<Vector3d> recall;
  if (tick.gait.mode == GaitMode::kExploring) {
    const double share = phase_ == GaitPhase::kRegrasp ? regrasp_.request().disc_share : 1.0;
    recall = centre + Shifted(home, TangentPart(share * found_[finger], home.normal_W)).p_OC_W;
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

bool FingerGait::MustBreakOff(const ControlTick& tick, const ObjectWrench& wrench) {
  const GaitParameters& parameters = tick.gait;
  if (Disturbed(tick.estimate, wrench, parameters.abort_position, parameters.abort_rotation))
    return true;
  if (!planned(tick)) return false;
  if (regrasp_.phase() == Regrasp::Phase::kUnload && !regrasp_began_) {
    regrasp_began_ = true;
    error_position_ = happened_.error_position;
    error_rotation_ = happened_.error_rotation;
  }
  const bool leaving = regrasp_.phase() == Regrasp::Phase::kUnload ||
                       regrasp_.phase() == Regrasp::Phase::kLift ||
                       regrasp_.phase() == Regrasp::Phase::kSlide;
  if (!leaving) return false;
  bool slips = false;
  for (int i : tick.grasp.without(regrasp_.finger())) {
    const int ticks = tick.finger(i).ticks_without_contact;
    slips |= ticks * tick.dt >= tick.gait.slip_s && ticks * tick.dt < tick.gait.away_s;
  }
  if (!slips &&
      happened_.error_position <
          error_position_ + tick.gait.leave_share * parameters.abort_position &&
      happened_.error_rotation <
          error_rotation_ + tick.gait.leave_share * parameters.abort_rotation)
    return false;
  caution_[regrasp_.finger()] += tick.gait.caution;
  return true;
}

void FingerGait::EndCycle(const ControlTick& tick, const ObjectWrench& wrench) {
  if (request_.make_room_for >= 0) {
    Enter(GaitPhase::kFinish);
    return;
  }
  if (refused_finger_ >= 0 && refused_finger_ == order_.back().finger && !sought_ &&
      !planned(tick)) {
    sought_ = true;  // once per cycle: contacts from which it may leave
    Enter(GaitPhase::kStance);
    return;
  }
  if (turned_before_ > 0) ++cycles_;
  if (there()) return Enter(GaitPhase::kFinish);  // while fingers regrasped
  idle_cycles_ = turned_before_ - turned_until_ < tick.gait.progress ? idle_cycles_ + 1 : 0;
  turned_until_ = turned_before_;
  // Forward what a reference that forgives has given up is no way ahead.
  stale_cycles_ = turned_before_ - turned_most_ < tick.gait.progress ? stale_cycles_ + 1 : 0;
  turned_most_ = std::max(turned_most_, turned_before_);
  const bool stale = planned(tick) && stale_cycles_ > kStale * tick.gait.patience;
  if (!stale && idle_cycles_ <= (planned(tick) ? tick.gait.patience : tick.gait.idle_cycles))
    return StartMotion(tick, wrench);
  if (stale) {
    std::snprintf(error_, sizeof(error_),
                  "the object cannot turn further: no farther than before in %d cycles",
                  stale_cycles_);
  } else if (refused_finger_ >= 0) {
    const auto text = MayNotLeave(tick.hand, refused_finger_, refused_margin_, refused_below_);
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

void FingerGait::Forgive(const ControlTick& tick, bool held, ObjectWrench* wrench) {
  turned_before_ += sign_ * forgiveness_.Forgive(tick, request_.axis_W, held, wrench);
}

ObjectMotion FingerGait::UpdateMotion(const ControlTick& tick, ObjectWrench* wrench) {
  const ObjectMotion motion = manipulation_.Update(tick, *wrench, home_);
  if (manipulation_.end() == LocalManipulation::End::kNone) return motion;
  EndMotion(tick);
  Forgive(tick, false, wrench);
  Enter(stop_ || there() ? GaitPhase::kFinish : GaitPhase::kSettle);
  return motion;
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
  if (happened_.explore_ended) Remember(finger, tick, wrench);
  if (regrasp_.active()) return;
  happened_.regrasp_ended = true;
  regrasp_began_ = false;
  if (!regrasp_.aborted()) caution_[finger] *= tick.gait.caution_kept;
  if (!regrasp_.aborted() && regrasp_.request().rub_s > 0) ++rubs_;
  misses_ = regrasp_.no_surface() ? misses_ + 1 : 0;
  if (regrasp_.no_surface() && (!planned(tick) || misses_ >= tick.gait.misses)) {
    std::snprintf(error_, sizeof(error_), "%s found no surface to stand on",
                  tick.hand.fingers[finger].name.c_str());
    Enter(GaitPhase::kFailed);
  } else if (stop_) {
    Enter(GaitPhase::kFinish);
  } else if (regrasp_.aborted()) {
    Enter(GaitPhase::kRecover);
  } else {
    ++regrasps_;
    if (regrasp_.no_surface()) {
      waiting_.add(finger);
    } else {
      let_by_ = put_off_;  // it may have cleared their way
      put_off_ = FingerSet();
    }
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

void FingerGait::UpdateStance(const ControlTick& tick) {
  if (stance_plan_.leaves() < 0)
    SearchStance(tick);
  else if (stance_plan_.Step(tick))
    EndStancePlan(tick);
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
      UpdateStance(tick);
      break;
    case GaitPhase::kObjectMotion:
      motion = UpdateMotion(tick, &wrench);
      break;
    case GaitPhase::kSettle:
      if (ticks_ * tick.dt >= tick.gait.settle_s) Enter(GaitPhase::kChoose);
      break;
    case GaitPhase::kChoose:
      if (planned(tick))
        NextPlanned(tick, wrench);
      else
        Next(tick, wrench);
      break;
    case GaitPhase::kPlan:
      if (plan_.Step(tick)) EndPlan(tick);
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
