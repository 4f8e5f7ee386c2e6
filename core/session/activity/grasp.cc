#include "core/session/activity/grasp.h"

#include <algorithm>
#include <cstdio>

#include "core/world/overlap_text.h"

namespace regrasp {

Verdict GraspActivity::MayStart(const Command&, const ActivityContext& context) {
  if (!context.world.stand_in())
    return {Verdict::Kind::kBadState,
            "the object is not presented to the hand; `regrasp reset` brings it back",
            "regrasp reset"};
  const auto overlap = OverlapText(context.world.start_overlap(), context.now.hand);
  if (overlap.front() == 0) return {};
  std::snprintf(refusal_.data(), refusal_.size(), "%s; %s", overlap.data(), kFitsObject);
  return {Verdict::Kind::kBadState, refusal_.data(),
          "rotation_deg in the object's .toml, object_pose in the hand's, or another object"};
}

void GraspActivity::Start(const Command&, const ActivityContext& context) {
  sequence_.Start(context.now, context.start.q_closed, context.start.p_WO_expected);
}

ActivityStep GraspActivity::Update(const ActivityContext& context) {
  World& world = context.world;
  sequence_.Update(context.now, &context.controller, &context.tasks);
  context.job.progress = std::min(0.99, sequence_.progress());
  if (world.stand_in() != sequence_.needs_stand_in()) {
    world.SetStandIn(sequence_.needs_stand_in());
    context.log.Emit(context.tick, EventKind::kStandIn, -1, world.stand_in(), "stand-in %s",
                     world.stand_in() ? "holds the object" : "let go");
  }
  if (sequence_.phase() == GraspSequence::Phase::kDone) return ActivityStep::Ended(JobState::kDone);
  if (sequence_.phase() == GraspSequence::Phase::kRestless) {
    char why[kReasonRoom];
    std::snprintf(why, sizeof why, "the object does not come to rest: it moves at %.1f mm/s",
                  1e3 * sequence_.drift_speed());
    return ActivityStep::Failed(why);
  }
  if (sequence_.phase() != GraspSequence::Phase::kFailed) return {};
  context.ToPosture(context.start.q_open);
  return ActivityStep::Failed("fewer than three fingers touched the object", SessionState::kIdle);
}

ActivityStep GraspActivity::Stop(const ActivityContext& context) {
  if (!context.world.stand_in()) return ActivityStep::Ended(JobState::kCancelled);
  context.ToPosture(context.start.q_open);
  return ActivityStep::Ended(JobState::kCancelled, SessionState::kIdle);
}

}  // namespace regrasp
