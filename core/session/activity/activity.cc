#include "core/session/activity/activity.h"

#include <cstdio>

namespace regrasp {

void ActivityContext::ToPosture(const JointVector& q) const {
  for (int i = 0; i < now.hand.num_fingers(); ++i) {
    const auto& joints = now.hand.fingers[i].joints;
    tasks[i] = FingerTask();
    tasks[i].q_target.resize(static_cast<Eigen::Index>(joints.size()));
    for (std::size_t k = 0; k < joints.size(); ++k) tasks[i].q_target[k] = q[joints[k]];
  }
}

ActivityStep ActivityStep::Ended(JobState job, SessionState next) {
  ActivityStep step;
  step.job = job;
  step.next = next;
  return step;
}

ActivityStep ActivityStep::Failed(const char* error, SessionState next) {
  ActivityStep step = Ended(JobState::kFailed, next);
  std::snprintf(step.error, sizeof(step.error), "%s", error);
  return step;
}

}  // namespace regrasp
