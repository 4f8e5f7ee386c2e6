#pragma once

/// Inside of Session, shared by the files of this folder only: the state of one run. session.cc has
/// the tick, as a straight line; commands.cc what commands do; watch.cc what is watched;
/// snapshot.cc what leaves.

#include <array>

#include "core/control/felt_friction.h"
#include "core/sensing/sensors.h"
#include "core/session/activity/all.h"
#include "core/session/quality_monitor.h"

namespace regrasp {

struct Session::Impl {
  static constexpr std::size_t kMaxPending = 64;  // finished jobs
  static constexpr int kJudgeInterval = 10;       // ticks between looks at the truth

  // session.cc
  explicit Impl(SessionConfig config);
  /// Valid until the next call.
  const SensorReading& Sense();
  void Tick();
  FingerSet GraspFingers() const;
  ActivityContext Context();
  /// What runs in this state; null for a state without a job.
  Activity* Running(SessionState in);
  /// The running activity, or the hold: the object's wanted motion.
  ObjectMotion Act();
  void HoldAll();

  // commands.cc
  void Enter(SessionState next);
  void StartJob(const Command& command, JobMethod method);
  void FinishJob(JobState end, const char* error);
  void Finish(const ActivityStep& step);
  Verdict Refuse(const Command& command, const Verdict& verdict);
  Verdict Apply(const Command& command);
  Verdict StartActivity(const Command& command, JobMethod method);
  void SetParameter(const Command& command);
  void Push(const Command& command);
  /// A run goes on from a checkpoint: its job gets a number of the present table, and with
  /// `reseed` everything random that comes later follows the new seed.
  void Branch(const Command& command);
  void StopJob();
  void ApplyParameters();
  bool job_running() const { return job.id != 0 && job.state == JobState::kRunning; }

  // feel.cc: the object's surface, from what the controller believes
  void Feel(const SensorReading& reading);
  void FeelFriction();
  /// What this tick goes by: parameters.control, with the friction that was felt where landings are
  /// planned, and parameters.shape.
  void CountOn();

  // watch.cc
  void WatchContacts();
  void WatchDrop();

  // snapshot.cc
  void Snapshot(Frame* frame);
  void RecordFinger(int finger, const KinematicsData& kinematics, FingerFrame* frame) const;
  std::uint64_t Hash() const;
  void Load(std::string_view bytes);
  /// What decides the future: the state hash, saved states.
  template <typename V>
  void Fields(V& v) {
    v("tick", tick);
    v("seed", seed);
    v("state", state, kLastState);
    v("parameters", parameters);
    v("world", world);
    v("sensors", sensors);
    v("estimator", estimator);
    v("felt", felt);
    v("felt_friction", felt_friction);
    v("judge", judge);
    v("monitor", monitor);
    v("controller", controller);
    v("tasks", tasks);
    v("motion", motion);
    v("job", job);
    v("push_until", push_until, kCountOrNone);
    v("drop_ticks", drop_ticks);
    v("was_in_contact", was_in_contact);
    // The activities that do not run begin with their Start.
    ForEachActivity(activities, [&](const JobInfo& row, auto& activity) {
      if (row.state == state) v(row.name.data(), activity);
    });
  }

  // Fixed for the run.
  const SessionConfig config;
  const HandModel& hand;
  const double dt;
  const StartPosture start;

  // The run.
  std::uint64_t seed;
  std::int64_t tick = 0;
  SessionState state = SessionState::kIdle;
  Parameters parameters;
  World world;
  Sensors sensors;
  StateEstimator estimator;  // what the controller believes
  FeltSurface felt;
  FeltFriction felt_friction;
  Judge judge;
  QualityMonitor monitor;
  HybridController controller;
  FingerTasks tasks;
  ObjectMotion motion;  // wanted in the last tick
  JobRecord job;
  Activities activities;
  std::int64_t push_until = -1;  // tick
  int drop_ticks = 0;            // in a row with fewer than two contacts
  std::array<bool, kMaxFingers> was_in_contact{};

  // Not part of the state.
  ControlParameters control;  // what the controller counts on in this tick
  JointVector torque;
  EventLog log;
  FixedVector<JobRecord, kMaxPending> finished, finished_out;
  bool measure = false;
  StageTimes times;
};

}  // namespace regrasp
