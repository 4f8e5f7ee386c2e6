#include "core/session/session_impl.h"

namespace regrasp {
void Session::Impl::WatchContacts() {
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const FingerEstimate& f = estimator.estimate().fingers[i];
    const bool now = was_in_contact[i] ? !f.lost : f.in_contact;
    if (now == was_in_contact[i]) continue;
    was_in_contact[i] = now;
    log.Emit(tick, now ? EventKind::kContactMade : EventKind::kContactLost, i, 0, "%s: contact %s",
             hand.fingers[i].name.c_str(), now ? "made" : "lost");
  }
}

void Session::Impl::WatchDrop() {
  if (!HoldsAlone(state, world.stand_in())) {
    drop_ticks = 0;
    return;
  }
  const Estimate& e = estimator.estimate();
  int touching = 0;
  for (const FingerEstimate& f : e.fingers) touching += f.in_contact;
  drop_ticks = touching < 2 ? drop_ticks + 1 : 0;
  const double distance = (e.p_WO - controller.wrench().p_ref()).norm();
  if (drop_ticks * dt < parameters.control.drop_contact_s &&
      distance < parameters.control.drop_distance)
    return;
  if (Activity* running = Running(state)) running->Dropped(Context());
  log.Emit(tick, EventKind::kDropped, -1, distance,
           "dropped: object %.0f mm from its place, %d fingers touch", distance * 1e3, touching);
  FinishJob(JobState::kFailed, "the object was dropped");
  Context().ToPosture(e.q);  // the hand stops where it is
  Enter(SessionState::kDropped);
}

}  // namespace regrasp
