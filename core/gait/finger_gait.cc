#include "core/gait/finger_gait.h"

#include <algorithm>
#include <cstdio>

namespace regrasp {
namespace {

constexpr double kRecoverLimit_s = 2.0;
constexpr double kRecovered = 0.5;        // of the limits at which a regrasp is broken off
constexpr double kSecondThought_s = 0.3;  // a refusal stands when the margin has been low so long
constexpr double kFinish_s = 0.4;
constexpr double kProgress = 0.02;   // rad: a cycle that turns the object less has not turned it
constexpr double kFoundShare = 0.5;  // weight of the newest exploration's end
constexpr double kInsideDisc = 0.9;  // of the disc's radius: what is remembered lies inside it
constexpr int kSearchTicks = 5;      // from one evaluation of a stance to the next
constexpr int kSearchLimit = 300;    // evaluations
constexpr double kMostLead = 0.35;   // rad
constexpr double kFullDisc = 0.5;    // of the wanted margin: from there on the whole disc is free
constexpr double kWantMore = 1.5;    // of the margin of the stance from which a finger was refused
constexpr int kIdleCycles = 3;       // cycles without progress before the gait gives up

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

void FingerGait::StartMotion(const GaitParameters& parameters) {
  const double left = std::abs(request_.angle_rad) - turned_before_;
  const double step =
      request_.continuous ? parameters.step_rad : std::min(parameters.step_rad, left);
  const double speed = request_.speed_rad_s > 0 ? request_.speed_rad_s : parameters.speed_rad_s;
  ObjectMotion per_rad;
  per_rad.w_W = sign_ * request_.axis_W;
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
                                     const GaitParameters& parameters) const {
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
      const double distance = (TargetOf(i, wrench, parameters).p_WC - tick.finger(i).p_WC).norm();
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
    Regrasp::Request request;
    request.slide.finger = step.finger;
    request.hop = parameters.hop;
    request.explore = exploring;
    request.slide.estimator = parameters.estimator;
    request.slide.seed = request_.seed + static_cast<std::uint64_t>(regrasps_);
    request.slide.criterion = Criterion::kSwitched;
    if (step.objective == GaitObjective::kStabilityWithoutNext &&
        pick + 1 < static_cast<int>(order_.size())) {
      request.slide.criterion = Criterion::kStability;
      request.slide.without = order_[pick + 1].finger;
    }
    request.slide.gradient_W = gradient_[step.finger];
    request.disc_share = DiscShare(tick);
    regrasp_.Start(request);
    happened_.regrasp_began = true;
    Enter(GaitPhase::kRegrasp);
    return;
  }
  EndCycle(tick);
}

void FingerGait::EndCycle(const ControlTick& tick) {
  if (request_.make_room_for >= 0) {
    Enter(GaitPhase::kFinish);
    return;
  }
  if (refused_finger_ >= 0 && refused_finger_ == order_.back().finger && !sought_) {
    sought_ = true;  // once per cycle: contacts from which it may leave
    Enter(GaitPhase::kStance);
    return;
  }
  if (turned_before_ > 0) ++cycles_;
  idle_cycles_ = turned_in_cycle_ < kProgress ? idle_cycles_ + 1 : 0;
  if (idle_cycles_ <= kIdleCycles) {
    StartMotion(tick.gait);
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
      } else {
        SearchStance(tick);
      }
      break;

    case GaitPhase::kObjectMotion:
      motion = manipulation_.Update(tick, wrench, home_);
      if (manipulation_.end() != LocalManipulation::End::kNone) {
        EndMotion();
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
        Next(tick, wrench);
      }
      break;

    case GaitPhase::kRegrasp: {
      if (!regrasp_.aborted() &&
          Disturbed(tick.estimate, wrench, parameters.abort_position, parameters.abort_rotation)) {
        regrasp_.Abort();
        happened_.aborted = true;
      }
      const Regrasp::Phase before = regrasp_.phase();
      const int finger = regrasp_.finger();
      regrasp_.Update(tick, TargetOf(finger, wrench, parameters), controller, tasks);
      happened_.changed |= regrasp_.phase() != before;
      happened_.explore_began = regrasp_.slide().slide_began();
      happened_.explore_ended = regrasp_.slide().slide_ended();
      if (happened_.explore_ended) Remember(finger, tick, wrench);
      if (regrasp_.active()) break;
      happened_.regrasp_ended = true;
      if (regrasp_.lost()) {
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
      break;
    }

    case GaitPhase::kRecover:
      if (stop_) {
        Enter(GaitPhase::kFinish);
      } else if (!Disturbed(tick.estimate, wrench, kRecovered * parameters.abort_position,
                            kRecovered * parameters.abort_rotation) ||
                 ticks_ * tick.dt > kRecoverLimit_s) {
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
