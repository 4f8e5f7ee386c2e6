#pragma once

/// What the trials of this folder do with a session: a job, ticked until it ends, with or without
/// pushes.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>

#include "core/common/random.h"
#include "core/session/session.h"

namespace regrasp {

struct JobOptions {
  double limit_s = 60;
  /// A push of so much for 0.1 s each second of the job, in random directions: the very pushes of
  /// `regrasp experiment rotation --push`.
  double push_n = 0;
  std::function<void(const Event&)> on_event = {};
};

/// Gives a job command and ticks until its job ends, or fails where it takes longer than the limit
/// (with id 0 then). The record.
inline JobRecord RunJob(Session& session, Command command, const JobOptions& options) {
  constexpr std::uint64_t kPushStream = 3000;
  static std::int64_t next_id = 1;
  command.job = next_id++;
  session.Apply(command);
  const std::int64_t begin = session.tick();
  const auto end = begin + static_cast<std::int64_t>(1000 * options.limit_s);
  RandomStream pushes(session.seed(), kPushStream);
  while (session.tick() < end) {
    const std::int64_t passed = session.tick() - begin;
    if (options.push_n > 0 && passed > 0 && passed % 1000 == 0) {
      Command push;
      push.type = CommandType::kPush;
      push.force_W = options.push_n * pushes.Normal3().normalized();
      push.duration_s = 0.1;
      session.Apply(push);
    }
    session.Tick();
    for (const Event& event : session.TakeEvents())
      if (options.on_event) options.on_event(event);
    for (const JobRecord& job : session.TakeFinishedJobs())
      if (job.id == command.job) return job;
  }
  JobRecord late;
  late.state = JobState::kFailed;
  std::snprintf(late.error, sizeof(late.error), "not finished after %.0f s", options.limit_s);
  return late;
}

/// Closes the hand on the object. Whether it holds.
inline bool GraspObject(Session& session, const JobOptions& options = {.limit_s = 20}) {
  Command grasp;
  grasp.type = CommandType::kGrasp;
  return RunJob(session, grasp, options).state == JobState::kDone;
}

}  // namespace regrasp
