/// How the finger gait turns the object: in motions by all fingers, and on while fingers regrasp.
#include <algorithm>
#include <cmath>

#include "core/gait/finger_gait.h"

namespace regrasp {

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
  per_rad.w_W += axis_W();
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
  const double speed =
      along_.Update(tick, wrench, tick.grasp.without(away), margin, axis_W(), most);
  ObjectMotion per_rad;
  if (parameters.forgive)
    per_rad = forgiveness_.WinBack(parameters, wrench, request_.axis_W, turned_so_far(),
                                   parameters.step_rad);
  turned_before_ += speed * tick.dt;
  turned_meanwhile_ += speed * tick.dt;
  return {speed * per_rad.v_W, speed * (per_rad.w_W + axis_W())};
}

}  // namespace regrasp
