#include "core/session/gait_report.h"

#include <numbers>

#include "core/gait/may_not_leave.h"

namespace regrasp {
namespace {

/// What the regrasp maximises now.
Criterion Counts(const Regrasp& regrasp) {
  return ActiveOf(regrasp.slide().request().criterion, regrasp.slide().on_stability());
}

}  // namespace

double GaitReport::TruePhi(const Regrasp& regrasp, const ActivityContext& context) const {
  const GuidedSlide::Request& request = regrasp.slide().request();
  context.judge.Look(context.tick, context.world.state(), context.parameters.control);
  return context.judge.Phi({Counts(regrasp), request.finger,
                            context.now.grasp.without(request.without), request.turn_axis_W},
                           context.parameters, regrasp.slide().on_stability());
}

void GaitReport::Regrasped(const Regrasp& regrasp, const ActivityContext& context) {
  last_.finger = regrasp.finger();
  last_.criterion = regrasp.slide().request().criterion;
  last_.aborted = regrasp.aborted();
  last_.phi_after = TruePhi(regrasp, context);
  if (!regrasp.request().explore) last_.phi_start = last_.phi_before;
  const Criterion criterion = Counts(regrasp);
  Event& event = context.log.Emit(context.tick, EventKind::kRegrasp, last_.finger, last_.phi_after,
                                  "%s regrasped: %s %.4f -> %.4f",
                                  context.now.hand.fingers[last_.finger].name.c_str(),
                                  Name(criterion).data(), last_.phi_before, last_.phi_after);
  if (regrasp.request().explore && InfoOf(criterion).phi_of != PhiOf::kStability && !last_.aborted)
    event.from = last_.phi_start;
}

void GaitReport::Report(const FingerGait& gait, const ActivityContext& context) {
  const FingerGait::Happened& happened = gait.happened();
  const Regrasp& regrasp = gait.regrasp();
  const int finger = regrasp.finger();
  const auto emit = [&](EventKind kind, int of, double value, const char* format, auto... args) {
    context.log.Emit(context.tick, kind, of, value, format, args...);
  };
  if (const Refusal& refused = happened.refused; refused.finger >= 0)
    emit(EventKind::kRefused, refused.finger, refused.margin, "%s",
         MayNotLeave(context.now.hand, refused.finger, refused.margin, refused.below).data());
  if (happened.aborted)
    emit(EventKind::kSlip, finger, happened.error_position,
         "regrasp broken off: object %.1f mm, %.0f deg off", happened.error_position * 1e3,
         happened.error_rotation * 180.0 / std::numbers::pi);
  if (happened.explore_began) last_.phi_start = TruePhi(regrasp, context);
  if (happened.regrasp_ended) Regrasped(regrasp, context);
  if (happened.regrasp_began) {
    last_ = RegraspRecord();
    last_.phi_before = TruePhi(regrasp, context);
  }
  if (!happened.changed || gait.phase() == GaitPhase::kChoose) return;
  if (gait.phase() == GaitPhase::kRegrasp)
    emit(EventKind::kGaitPhase, finger, static_cast<double>(gait.phase()), "%s: %s",
         context.now.hand.fingers[finger].name.c_str(), Name(regrasp.phase()).data());
  else
    emit(EventKind::kGaitPhase, -1, static_cast<double>(gait.phase()), "%s",
         Name(gait.phase()).data());
}

}  // namespace regrasp
