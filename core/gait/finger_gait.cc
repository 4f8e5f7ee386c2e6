#include "core/gait/finger_gait.h"

#include <algorithm>
#include <cstdio>

namespace regrasp {
namespace {

constexpr double kRecoverLimit_s = 2.0;
constexpr double kRecovered = 0.5;        // of the limits at which a regrasp is broken off
constexpr double kSecondThought_s = 0.3;  // a refusal stands when the margin has been low so long
constexpr double kFinish_s = 0.4;
constexpr double kProgress = 0.02;    // rad: a cycle that turns the object less has not turned it
constexpr double kFoundShare = 0.5;   // weight of the newest exploration's end
constexpr double kInsideDisc = 0.9;   // of the disc's radius: what is remembered lies inside it
constexpr int kSearchTicks = 5;       // from one evaluation of a stance to the next
constexpr int kSearchLimit = 300;     // evaluations
constexpr double kMostLead = 0.35;    // rad
constexpr double kFullDisc = 0.5;     // of the wanted margin: from there on the whole disc is free
constexpr double kWantMore = 1.5;     // of the margin of the stance from which a finger was refused
constexpr double kPlanReach = 0.010;  // candidates lie so far about home [m]
constexpr double kRoomReach = 0.015;  // ... to make room for a refused finger [m]
constexpr double kRoomGain = 0.05;    // of the load margin: worth a regrasp that makes room [N]
constexpr double kReserveNeeded = 0.3;  // a refused finger with as much may stay behind [rad]
constexpr double kStanceReach = 0.015;  // of the stance plan's contacts from the present ones [m]
constexpr double kSteady_s = 0.04;      // a finger that has touched so long stands
constexpr double kAway_s = 0.1;         // one that has not for so long is not counted on
constexpr double kLeaveShare = 0.4;     // of the errors that break a regrasp off, while it leaves
constexpr double kLeastMargin = 0.02;   // asked for after many cycles without progress [N]
constexpr double kWorth = 0.05, kWorthScarce = 0.4;  // gain in J for which a finger leaves
constexpr int kSlipTicks = 4;     // another finger without contact: the load transfer failed
constexpr double kStill_s = 1.0;  // the object has rested for so long at the end of a recovery
constexpr double kStillPosition = 0.001, kStillRotation = 0.1;  // [m, rad]
constexpr double kCaution = 0.2;                                // more load margin after that [N]
constexpr double kCautionKept = 0.5;    // of it after a regrasp that went well
constexpr int kMisses = 15;             // in a row before the gait gives up
constexpr int kPatience = 20;           // cycles without progress before it does, when planning
constexpr double kForgiveMargin = 0.3;  // [N]
constexpr double kKeptPosition = 0.001,
                 kKeptRotation = 0.07;                   // of an error that is forgiven [m, rad]
constexpr double kTiltBack = 0.12, kDriftBack = 0.0025;  // won back per motion, at most [rad, m]
constexpr int kIdleCycles = 3;  // cycles without progress before the gait gives up

}  // namespace

std::string_view Name(GaitPhase phase) {
  switch (phase) {
    case GaitPhase::kIdle:
      return "idle";
    case GaitPhase::kObjectMotion:
      return "object motion";
    case GaitPhase::kStance:
      return "stance";
    case GaitPhase::kSettle:
      return "settle";
    case GaitPhase::kChoose:
      return "choose";
    case GaitPhase::kRegrasp:
      return "regrasp";
    case GaitPhase::kRecover:
      return "recover";
    case GaitPhase::kFinish:
      return "finish";
    case GaitPhase::kDone:
      return "done";
    case GaitPhase::kFailed:
      return "failed";
    case GaitPhase::kPlan:
      return "plan";
  }
  return "";
}

void FingerGait::Start(const Request& request, const ControlTick& tick,
                       const ObjectWrench& wrench) {
  *this = FingerGait();
  request_ = request;
  sign_ = request.angle_rad < 0 ? -1.0 : 1.0;
  order_ = MakeGaitOrder(tick.hand, tick.estimate, tick.grasp);
  home_ = MakeHome(tick.estimate, wrench);
  first_stance_ = home_.stance;
  q_start_ = wrench.q_ref();
  p_start_ = wrench.p_ref();
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

void FingerGait::SearchStance(const ControlTick& tick) {
  const ControlParameters& control = tick.control;
  if (ticks_ == 1) {
    const int opposing = order_.empty() ? -1 : order_.back().finger;
    const int leaves = request_.make_room_for >= 0 ? request_.make_room_for : opposing;
    margin_wanted_ = std::max(tick.gait.margin_wanted, kWantMore * margin_wanted_);
    search_.Start(first_stance_, home_.stance, tick.grasp, leaves, tick.gait.max_shift,
                  request_.seed + static_cast<std::uint64_t>(searches_++));
  }
  if (ticks_ % kSearchTicks == 0)
    search_.Step(control.mass_estimate * tick.gravity_W, control.friction_estimate,
                 tick.estimate.object_scale, control.max_normal_force);
  if (search_.margin() < margin_wanted_ && search_.evaluations() < kSearchLimit) return;
  home_.stance = search_.stance();
  waiting_ = tick.grasp.without(request_.make_room_for);
  Enter(GaitPhase::kChoose);
}

void FingerGait::Remember(int finger, const ControlTick& tick, const ObjectWrench& wrench) {
  const Vector3d shift = tick.finger(finger).p_WC - wrench.p_ref() - HomeOf(finger, tick.gait).p_OC;
  Vector3d& found = found_[finger];
  found += kFoundShare * (shift - found);
  const double limit = kInsideDisc * tick.gait.disc_radius;
  if (found.norm() > limit) found *= limit / found.norm();
  gradient_[finger] = regrasp_.slide().algorithm().gradient_W();
}

void FingerGait::StartMotion(const GaitParameters& parameters, const ObjectWrench& wrench) {
  const double left = std::abs(request_.angle_rad) - turned_before_;
  const double step =
      request_.continuous ? parameters.step_rad : std::min(parameters.step_rad, left);
  const double speed = request_.speed_rad_s > 0 ? request_.speed_rad_s : parameters.speed_rad_s;
  ObjectMotion per_rad;
  per_rad.w_W = sign_ * request_.axis_W;
  if (parameters.forgive && step > 0.5 * parameters.step_rad) {
    // What was given up of tilt and place is won back on the way.
    const Quaterniond ideal =
        FromRotationVector(sign_ * turned_before_ * request_.axis_W) * q_start_;
    const Vector3d tilt =
        TangentPart(RotationVector(ideal * wrench.q_ref().conjugate()), request_.axis_W);
    per_rad.w_W += LimitNorm(tilt, kTiltBack) / step;
    per_rad.v_W += LimitNorm(p_start_ - wrench.p_ref(), kDriftBack) / step;
  }
  manipulation_.Start(per_rad, step, speed, parameters.acceleration,
                      LocalManipulation::AtLimit::kEnds);
  Enter(GaitPhase::kObjectMotion);
}

void FingerGait::EndMotion() {
  turned_before_ += manipulation_.travelled();
  turned_in_cycle_ = manipulation_.travelled();
  if (const int finger = manipulation_.end_finger(); finger >= 0) {
    double& lead = lead_[finger];
    lead = std::min(kMostLead, lead + 0.5 * (manipulation_.length() - turned_in_cycle_));
  }
  for (const GaitStep& step : order_) waiting_.add(step.finger);
  refused_finger_ = -1;
  sought_ = false;
  room_for_ = -1;
  made_room_ = sought_for_ = FingerSet();
}

double FingerGait::DiscShare(const ControlTick& tick) const {
  if (order_.empty()) return 1;
  const GaitParameters& parameters = tick.gait;
  const double margin = tick.margins.without[order_.back().finger] - parameters.margin_min;
  const double wanted = kFullDisc * parameters.margin_wanted - parameters.margin_min;
  return wanted > 0 ? std::clamp(margin / wanted, 0.0, 1.0) : 1.0;
}

StanceContact FingerGait::HomeOf(int finger, const GaitParameters& parameters) const {
  const double lead =
      request_.make_room_for >= 0 ? 0.0 : parameters.lead * parameters.step_rad + lead_[finger];
  const Quaterniond ahead = FromRotationVector(-sign_ * lead * request_.axis_W);
  const StanceContact& first = home_.stance[finger];
  return {ahead * first.p_OC, ahead * first.p_OF, ahead * first.normal_W};
}

Regrasp::Target FingerGait::TargetOf(int finger, const ObjectWrench& wrench,
                                     const ControlTick& tick) const {
  const GaitParameters& parameters = tick.gait;
  if (planned(tick) && landing_[finger].found) {
    const Landing& landing = landing_[finger];
    const Vector3d& p_WO = tick.estimate.p_WO;
    const Quaterniond& q_WO = tick.estimate.q_WO;
    const Vector3d p_WC = p_WO + q_WO * landing.p_OC;
    return {p_WC, p_WO + q_WO * landing.p_OF, q_WO * landing.normal_O, p_WC, p_WO};
  }
  const StanceContact home = HomeOf(finger, parameters);
  Vector3d recall = Vector3d::Zero();
  if (parameters.mode == GaitMode::kExploring) {
    const double share = phase_ == GaitPhase::kRegrasp ? regrasp_.request().disc_share : 1.0;
    recall = Shifted(home, TangentPart(share * found_[finger], home.normal_W)).p_OC;
  }
  const Vector3d& centre = wrench.p_ref();
  return {centre + home.p_OC, centre + home.p_OF, home.normal_W, centre + recall, centre};
}

bool FingerGait::Disturbed(const Estimate& estimate, const ObjectWrench& wrench, double position,
                           double rotation) {
  happened_.error_position = (wrench.p_ref() - estimate.p_WO).norm();
  happened_.error_rotation = RotationVector(wrench.q_ref() * estimate.q_WO.conjugate()).norm();
  return happened_.error_position > position || happened_.error_rotation > rotation;
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
  request.explore = tick.gait.mode == GaitMode::kExploring && request_.make_room_for < 0;
  request.slide.seed = request_.seed + static_cast<std::uint64_t>(regrasps_);
  request.slide.criterion = Criterion::kSwitched;
  if (step.objective == GaitObjective::kStabilityWithoutNext && next >= 0) {
    request.slide.criterion = Criterion::kStability;
    request.slide.without = next;
  }
  request.slide.gradient_W = gradient_[step.finger];
  request.disc_share = DiscShare(tick);
  return request;
}

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
  const bool worth =
      !landing.stays &&
      (makes_room ? landing.margin > tick.margins.without[room_for_] + kRoomGain
                  : far > tick.gait.skip_distance && landing.gain > kWorth + kWorthScarce * scarce);
  Enter(GaitPhase::kChoose);
  if (landing.found && worth) StartRegrasp(tick, finger, landing);
}

void FingerGait::StartRegrasp(const ControlTick& tick, int finger, const Landing& landing) {
  landing_[finger] = landing;
  GaitStep step{finger, GaitObjective::kManipulability};
  for (const GaitStep& row : order_)
    if (row.finger == finger) step = row;
  regrasp_.Start(RequestOf(step, plan_.request().next, tick));
  happened_.regrasp_began = true;
  Enter(GaitPhase::kRegrasp);
}

bool FingerGait::Unsteady(const ControlTick& tick) const {
  for (int i : tick.grasp) {
    const FingerEstimate& f = tick.finger(i);
    const bool steady = f.ticks_without_contact == 0 && f.ticks_in_contact * tick.dt >= kSteady_s;
    const bool away = f.ticks_without_contact * tick.dt >= kAway_s;
    if (!steady && !away) return true;
  }
  return false;
}

bool FingerGait::MayLeave(const ControlTick& tick, int finger) const {
  // Without progress it is tried with less: the load transfer is careful, and ends in time.
  const double needed = std::max(kLeastMargin, tick.gait.margin_min * std::exp2(-idle_cycles_));
  return tick.margins.without[finger] >= needed + caution_[finger];
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
  const bool leaving =
      regrasp_.phase() == Regrasp::Phase::kUnload || regrasp_.phase() == Regrasp::Phase::kLift;
  if (!leaving) return false;
  bool slips = false;
  for (int i : tick.grasp.without(regrasp_.finger())) {
    const int ticks = tick.finger(i).ticks_without_contact;
    slips |= ticks >= kSlipTicks && ticks * tick.dt < kAway_s;
  }
  if (!slips &&
      happened_.error_position < error_position_ + kLeaveShare * parameters.abort_position &&
      happened_.error_rotation < error_rotation_ + kLeaveShare * parameters.abort_rotation)
    return false;
  caution_[regrasp_.finger()] += kCaution;
  return true;
}

void FingerGait::EndStancePlan(const ControlTick& tick) {
  Enter(GaitPhase::kChoose);
  room_for_ = stance_plan_.leaves();
  if (stance_plan_.margin() > stance_plan_.first_margin() + kRoomGain)
    stance_queue_ = tick.grasp.without(room_for_);
}

void FingerGait::NextPlanned(const ControlTick& tick, const ObjectWrench& wrench) {
  if (Unsteady(tick) && ticks_ * tick.dt < kSecondThought_s) return;
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
        if (MayLeave(tick, i)) return StartPlan(i, kRoomReach, tick);
      }
      room_for_ = -1;
    }
  }
  for (const GaitStep& step : order_) {
    if (!waiting_.contains(step.finger) || !MayLeave(tick, step.finger)) continue;
    waiting_.remove(step.finger);
    return StartPlan(step.finger, kPlanReach, tick);
  }
  if (waiting_.empty()) return EndCycle(tick, wrench);
  // The margins still remember the finger before in the air.
  if (ticks_ * tick.dt < kSecondThought_s) return;
  // Of the fingers that must come along, the one that is nearest to leaving.
  int refused = -1;
  for (int i : waiting_)
    if (refused < 0 || tick.margins.without[i] > tick.margins.without[refused]) refused = i;
  const bool must = ReserveOf(tick, refused) < kReserveNeeded || idle_cycles_ > 0 ||
                    tick.margins.all < 0.5 * tick.gait.margin_wanted;
  if (must && !made_room_.contains(refused)) {
    made_room_.add(refused);
    room_for_ = refused;
    room_queue_ = tick.grasp.without(refused);
    return;
  }
  if (must && !sought_for_.contains(refused)) {
    sought_for_.add(refused);
    stance_plan_.Start(tick, refused, kStanceReach,
                       request_.seed + static_cast<std::uint64_t>(searches_++));
    return Enter(GaitPhase::kStance);
  }
  refused_finger_ = happened_.refused_finger = refused;
  refused_margin_ = happened_.refused_margin = tick.margins.without[refused];
  waiting_.remove(refused);
}

double FingerGait::ReserveOf(const ControlTick& tick, int finger) const {
  const FingerPosture now =
      PostureAt(tick.hand, finger, AnglesOf(tick.hand, finger, tick.estimate.q));
  return MotionReserve(tick.hand, finger, now, tick.estimate.p_WO, sign_ * request_.axis_W,
                       tick.gait.limit_margin, kReserveNeeded);
}

void FingerGait::Forgive(const ControlTick& tick, ObjectWrench* wrench) {
  const GaitParameters& parameters = tick.gait;
  const bool still =
      phase_ == GaitPhase::kRecover && (tick.estimate.p_WO - p_still_).norm() < kStillPosition &&
      RotationVector(tick.estimate.q_WO * q_still_.conjugate()).norm() < kStillRotation;
  if (!parameters.forgive || (tick.margins.all < kForgiveMargin && !still) ||
      !Disturbed(tick.estimate, *wrench, kRecovered * parameters.abort_position,
                 kRecovered * parameters.abort_rotation))
    return;
  const Estimate& estimate = tick.estimate;
  const Vector3d position = LimitNorm(wrench->p_ref() - estimate.p_WO, kKeptPosition);
  const Vector3d rotation =
      LimitNorm(RotationVector(wrench->q_ref() * estimate.q_WO.conjugate()), kKeptRotation);
  const Quaterniond q_new = (FromRotationVector(rotation) * estimate.q_WO).normalized();
  const double twist = RotationVector(q_new * wrench->q_ref().conjugate()).dot(request_.axis_W);
  turned_before_ += sign_ * twist;
  wrench->SetReference(estimate.p_WO + position, q_new);
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
    const bool refused = tick.margins.without[step.finger] < parameters.margin_min;
    // The margin still remembers the finger before in the air.
    if (refused && ticks_ * tick.dt < kSecondThought_s) return;
    waiting_.remove(step.finger);
    if (refused) {
      refused_finger_ = happened_.refused_finger = step.finger;
      refused_margin_ = happened_.refused_margin = tick.margins.without[step.finger];
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
  idle_cycles_ = turned_in_cycle_ < kProgress ? idle_cycles_ + 1 : 0;
  if (idle_cycles_ <= (planned(tick) ? kPatience : kIdleCycles)) {
    StartMotion(tick.gait, wrench);
    return;
  }
  if (refused_finger_ >= 0) {
    std::snprintf(error_, sizeof(error_),
                  "%s may not leave: the load margin without it is %.3f N, below %.3f N",
                  tick.hand.fingers[refused_finger_].name.c_str(), refused_margin_,
                  tick.gait.margin_min);
  } else {
    const int finger = manipulation_.end_finger();
    std::snprintf(error_, sizeof(error_), "the object cannot turn further: %s%s%s",
                  Name(manipulation_.end()).data(), finger >= 0 ? " of " : "",
                  finger >= 0 ? tick.hand.fingers[finger].name.c_str() : "");
  }
  Enter(GaitPhase::kFailed);
}

ObjectMotion FingerGait::Update(const ControlTick& tick, HybridController* controller,
                                FingerTasks* tasks) {
  happened_ = Happened();
  ObjectMotion motion;
  if (!active()) return motion;
  ++ticks_;
  const GaitParameters& parameters = tick.gait;
  for (int i : tick.grasp.without(finger())) {
    FingerTask& task = (*tasks)[i];
    task.mode = FingerMode::kHold;
    task.cap = tick.control.max_normal_force;
    task.grip = parameters.grip_force;
  }
  const ObjectWrench& wrench = controller->wrench();

  switch (phase_) {
    case GaitPhase::kStance:
      if (stop_) {
        Enter(GaitPhase::kFinish);
      } else if (stance_plan_.leaves() >= 0) {
        if (stance_plan_.Step(tick)) EndStancePlan(tick);
      } else {
        SearchStance(tick);
      }
      break;

    case GaitPhase::kObjectMotion:
      motion = manipulation_.Update(tick, wrench, home_);
      if (manipulation_.end() != LocalManipulation::End::kNone) {
        EndMotion();
        Forgive(tick, &controller->wrench());
        const bool there =
            !request_.continuous && turned_before_ > std::abs(request_.angle_rad) - 1e-3;
        Enter(stop_ || there ? GaitPhase::kFinish : GaitPhase::kSettle);
      }
      break;

    case GaitPhase::kSettle:
      if (stop_) {
        Enter(GaitPhase::kFinish);
      } else if (ticks_ * tick.dt >= parameters.settle_s) {
        Enter(GaitPhase::kChoose);
      }
      break;

    case GaitPhase::kChoose:
      if (stop_) {
        Enter(GaitPhase::kFinish);
      } else {
        if (planned(tick))
          NextPlanned(tick, wrench);
        else
          Next(tick, wrench);
      }
      break;

    case GaitPhase::kPlan:
      if (stop_)
        Enter(GaitPhase::kFinish);
      else if (plan_.Step(tick))
        EndPlan(tick);
      break;

    case GaitPhase::kRegrasp: {
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
      if (regrasp_.active()) break;
      happened_.regrasp_ended = true;
      regrasp_began_ = false;
      if (!regrasp_.aborted()) caution_[finger] *= kCautionKept;
      misses_ = regrasp_.lost() ? misses_ + 1 : 0;
      if (regrasp_.lost() && (!planned(tick) || misses_ >= kMisses)) {
        std::snprintf(error_, sizeof(error_), "%s found no surface to stand on",
                      tick.hand.fingers[finger].name.c_str());
        Enter(GaitPhase::kFailed);
      } else if (stop_) {
        Enter(GaitPhase::kFinish);
      } else if (regrasp_.aborted()) {
        Enter(GaitPhase::kRecover);
      } else {
        ++regrasps_;
        if (regrasp_.lost()) waiting_.add(finger);
        Enter(GaitPhase::kChoose);
      }
      break;
    }

    case GaitPhase::kRecover:
      if (ticks_ * tick.dt < kRecoverLimit_s - kStill_s) {
        p_still_ = tick.estimate.p_WO;
        q_still_ = tick.estimate.q_WO;
      }
      if (stop_) {
        Enter(GaitPhase::kFinish);
      } else if (!Disturbed(tick.estimate, wrench, kRecovered * parameters.abort_position,
                            kRecovered * parameters.abort_rotation) ||
                 ticks_ * tick.dt > kRecoverLimit_s) {
        Forgive(tick, &controller->wrench());
        Enter(GaitPhase::kChoose);
      }
      break;

    case GaitPhase::kFinish:
      if (stop_ || ticks_ * tick.dt >= kFinish_s) Enter(GaitPhase::kDone);
      break;

    case GaitPhase::kIdle:
    case GaitPhase::kDone:
    case GaitPhase::kFailed:
      break;
  }
  return motion;
}

}  // namespace regrasp
