#include "core/gait/regrasp.h"

namespace regrasp {

std::string_view Name(Regrasp::Phase phase) {
  using Phase = Regrasp::Phase;
  switch (phase) {
    case Phase::kIdle:
      return "idle";
    case Phase::kUnload:
      return "unload";
    case Phase::kLift:
      return "lift";
    case Phase::kAcross:
      return "across";
    case Phase::kDown:
      return "down";
    case Phase::kSeek:
      return "seek";
    case Phase::kGoBack:
      return "go back";
    case Phase::kSlide:
      return "slide";
    case Phase::kSettle:
      return "settle";
    case Phase::kRecall:
      return "recall";
    case Phase::kExplore:
      return "explore";
    case Phase::kReturn:
      return "return";
    case Phase::kReload:
      return "reload";
    case Phase::kDone:
      return "done";
  }
  return "";
}

void Regrasp::Start(const Request& request) {
  *this = Regrasp();
  request_ = request;
  request_.slide.leaves = true;
  slide_.Start(request_.slide);
}

void Regrasp::Abort() {
  if (!active()) return;
  aborted_ = true;
  slide_.Stop();
}

Regrasp::Phase Regrasp::phase() const {
  switch (slide_.phase()) {
    case GuidedSlide::Phase::kIdle:
      return Phase::kIdle;
    case GuidedSlide::Phase::kUnload:
      return Phase::kUnload;
    case GuidedSlide::Phase::kAway:
      if (!request_.hop || hop_.phase() == Hop::Phase::kIdle) return Phase::kSlide;
      return hop_.phase() == Hop::Phase::kAcross   ? Phase::kAcross
             : hop_.phase() == Hop::Phase::kDown   ? Phase::kDown
             : hop_.phase() == Hop::Phase::kSeek   ? Phase::kSeek
             : hop_.phase() == Hop::Phase::kGoBack ? Phase::kGoBack
                                                   : Phase::kLift;
    case GuidedSlide::Phase::kSettle:
      return Phase::kSettle;
    case GuidedSlide::Phase::kRecall:
      return Phase::kRecall;
    case GuidedSlide::Phase::kExplore:
      return Phase::kExplore;
    case GuidedSlide::Phase::kReturn:
      return Phase::kReturn;
    case GuidedSlide::Phase::kReload:
      return Phase::kReload;
    case GuidedSlide::Phase::kDone:
      return Phase::kDone;
  }
  return Phase::kIdle;
}

void Regrasp::Update(const ControlTick& tick, const Target& target, HybridController* controller,
                     FingerTasks* tasks) {
  if (!active()) return;
  const bool away = slide_.phase() == GuidedSlide::Phase::kAway;
  const GaitParameters& parameters = tick.gait;
  SlideProfile profile;
  profile.transfer_s =
      slide_.phase() == GuidedSlide::Phase::kUnload ? request_.transfer_s : parameters.transfer_s;
  const bool lifts = request_.hop && request_.rub_s <= 0;
  profile.leave_force = lifts ? parameters.hop_force : parameters.slide_force;
  profile.grip_force = parameters.grip_force;
  profile.settle_s = parameters.explore_settle_s;
  profile.explore_s = parameters.explore_s;
  profile.return_limit_s = parameters.return_limit_s;
  const SlideGuide guide{target.p_WC, request_.disc_share * parameters.disc_radius, target.p_WR};
  slide_.Update(tick, profile, guide, controller, tasks);
  if (away) {
    Travel(tick, target, &(*tasks)[finger()]);
  } else if (lifts && slide_.phase() == GuidedSlide::Phase::kAway) {
    hop_.Start(tick, finger(), request_.over_surface);
  }
}

void Regrasp::Travel(const ControlTick& tick, const Target& target, FingerTask* task) {
  if (!request_.hop) {
    if (SlideOver(tick, target, task)) slide_.Land(request_.explore);
    return;
  }
  if (hop_.phase() == Hop::Phase::kIdle) {
    if (SlideOver(tick, target, task) || slide_ticks_ * tick.dt > request_.rub_s)
      hop_.Start(tick, finger(), request_.over_surface);
    return;
  }
  hop_.Update(tick, {target.p_WF, target.normal_W, target.p_WO, target.w_W}, aborted_, task);
  if (hop_.phase() == Hop::Phase::kLanded) slide_.Land(request_.explore);
  if (hop_.phase() == Hop::Phase::kBlocked) slide_.Land(false);
}

bool Regrasp::SlideOver(const ControlTick& tick, const Target& target, FingerTask* task) {
  const GaitParameters& parameters = tick.gait;
  const FingerEstimate& f = tick.finger(finger());
  const Vector3d error = TangentPart(target.p_WC - f.p_WC, f.normal_W);
  task->mode = FingerMode::kSlide;
  task->force = parameters.slide_force;
  task->v_W = SlideTowards(error, parameters.slide_gain, parameters.slide_speed);
  return aborted_ || error.norm() < parameters.slide_arrived ||
         ++slide_ticks_ * tick.dt > parameters.slide_limit_s;
}

}  // namespace regrasp
