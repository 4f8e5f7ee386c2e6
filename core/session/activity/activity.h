#pragma once

/// What the hand does while a job runs. Each activity is one file of this folder with one shape:
/// MayStart and Start at its command, Update once a tick, Stop when the user ends it, Dropped when
/// the object is lost, Record for what leaves the session. All numbers that an activity keeps from
/// one tick to the next are members of its class.

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"
#include "core/session/command.h"
#include "core/session/event_log.h"
#include "core/session/frame.h"
#include "core/session/judge.h"
#include "core/session/parameters.h"
#include "core/session/session.h"
#include "core/session/start.h"
#include "core/world/world.h"

namespace regrasp {

/// What an activity works with. The world is there for the stand-in and for judging only.
struct ActivityContext {
  ControlTick now;    ///< what its controllers see
  std::int64_t tick;  ///< the present one
  std::uint64_t seed;
  const Parameters& parameters;
  const StartPosture& start;
  HybridController& controller;
  FingerTasks& tasks;
  World& world;
  Judge& judge;
  EventLog& log;
  JobRecord& job;  ///< of this activity

  double job_time_s() const { return static_cast<double>(tick - job.start_tick) * now.dt; }
  /// All fingers to a posture [rad].
  void ToPosture(const JointVector& q) const;
};

/// What an activity comes to in a tick.
struct ActivityStep {
  ObjectMotion motion;                         ///< wanted of the object in this tick
  JobState job = JobState::kRunning;           ///< anything else: the activity has ended ...
  SessionState next = SessionState::kHolding;  ///< ... and what comes after it
  char error[sizeof(JobRecord::error)] = {};   ///< kFailed: why

  bool ended() const { return job != JobState::kRunning; }
  /// Ended with the job done or cancelled.
  static ActivityStep Ended(JobState job, SessionState next = SessionState::kHolding);
  /// Ended with the job failed.
  static ActivityStep Failed(const char* error, SessionState next = SessionState::kHolding);
};

class Activity {
 public:
  virtual ~Activity() = default;
  /// Whether what the command asks for is there. The reason of a refusal is valid until the next
  /// call.
  virtual Verdict MayStart(const Command&, const ActivityContext&) { return {}; }
  /// Begins; nothing is left of an earlier run.
  virtual void Start(const Command& command, const ActivityContext& context) = 0;
  /// One tick: sets the tasks of the fingers.
  virtual ActivityStep Update(const ActivityContext& context) = 0;
  /// The user ends it: at once, or a few ticks later by Update.
  virtual ActivityStep Stop(const ActivityContext& context) = 0;
  /// The object is lost: what the job's record has to say about it.
  virtual void Dropped(const ActivityContext&) {}
  /// Whether all of the friction felt counts, even above control.feel_most.
  virtual bool Dares(const GaitParameters&) const { return false; }
  /// Joint torques in addition to the controller's, in a tick in which Update has run [N m].
  virtual void AddTorque(const ActivityContext&, JointVector*) const {}
  /// Its part of a frame; `frame` has everything else already.
  virtual void Record(const ActivityContext&, Frame*) const {}
};

}  // namespace regrasp
