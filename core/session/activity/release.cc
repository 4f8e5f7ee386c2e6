#include "core/session/activity/release.h"

#include <algorithm>

namespace regrasp {
ActivityStep ReleaseActivity::Update(const ActivityContext& context) {
  const double time = context.job_time_s();
  if (time == 0) context.ToPosture(context.start.q_open);
  context.job.progress = std::min(0.99, time / context.now.control.release_s);
  if (time < context.now.control.release_s) return {};
  return ActivityStep::Ended(JobState::kDone, SessionState::kIdle);
}

void ReleaseActivity::AddTorque(const ActivityContext& context, JointVector* torque) const {
  if (context.job_time_s() >= context.now.control.release_pull_s) return;
  for (int i = 0; i < context.now.hand.num_fingers(); ++i) {
    const FingerEstimate& f = context.now.estimate.fingers[i];
    if (!f.ever_in_contact) continue;
    const FingerVector tau = f.J.transpose() * (context.now.control.release_pull * f.normal_W);
    const auto& joints = context.now.hand.fingers[i].joints;
    for (std::size_t k = 0; k < joints.size(); ++k)
      (*torque)[joints[k]] += tau[static_cast<Eigen::Index>(k)];
  }
}

}  // namespace regrasp
