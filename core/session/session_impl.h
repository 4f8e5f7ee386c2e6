#pragma once

/// Inside of Session, shared by the files of this folder only: the state of one run, and the member
/// functions by file. session.cc has the tick, as a straight line.

#include <array>
#include <cstdio>
#include <initializer_list>
#include <memory>

#include "core/common/random.h"
#include "core/control/grasp_sequence.h"
#include "core/control/hybrid_controller.h"
#include "core/exploration/finger_exploration.h"
#include "core/gait/finger_gait.h"
#include "core/gait/object_move.h"
#include "core/sensing/sensors.h"
#include "core/session/quality_monitor.h"
#include "core/session/session.h"

namespace regrasp {

struct Session::Impl {
  static constexpr std::size_t kMaxPending = 64;  // events, jobs
  static constexpr int kJudgeInterval = 10;       // ticks between looks at the truth

  // session.cc
  explicit Impl(SessionConfig config);
  void Sense();
  void Tick();

  // start.cc: the state at tick 0
  void Build(std::uint64_t new_seed);
  /// Moves each fingertip's way in by start.displacement_m, along the surface in a random
  /// direction.
  void Displace(const Vector3d& p_WO, RandomStream* random,
                std::initializer_list<JointVector*> postures);
  /// Inverse kinematics by damped least squares; stops at joint limits.
  void MoveTip(int finger, const Vector3d& target, JointVector* q) const;
  void ToPosture(const JointVector& q);
  void HoldAll();

  // commands.cc: commands, jobs and events
  void Enter(SessionState next);
  void StartJob(const Command& command, JobMethod method);
  void FinishJob(JobState end, const char* error);
  Verdict Refuse(const Command& command, const Verdict& verdict);
  /// Whether there is such a finger and it touches.
  Verdict MayExplore(int finger);
  Verdict Apply(const Command& command);
  void SetParameter(const Command& command);
  /// A run goes on from a checkpoint: its job gets a number of the present table, and with
  /// `reseed` everything random that comes later follows the new seed.
  void Branch(const Command& command);
  void StopJob();
  bool job_running() const { return job.id != 0 && job.state == JobState::kRunning; }
  template <typename... Args>
  void Emit(EventKind kind, int finger, double value, const char* format, Args... args) {
    Event event;
    event.tick = tick;
    event.kind = kind;
    event.finger = finger;
    event.value = value;
    std::snprintf(event.text, sizeof(event.text), format, args...);
    events.push_back(event);
  }

  // feel.cc: the object's surface, from what the controller believes
  void Feel();

  // activities.cc: what the hand does, one Update a tick
  FingerSet GraspFingers() const;
  /// What the controllers of this tick work on.
  ControlTick MakeTick() const;
  /// Algorithm 1; before it, where the load margin without the finger is too small, the other
  /// fingers shift until it may leave.
  void StartExploration(const Command& command);
  void MakeRoom();
  void UpdateExploration();
  void StartRotation(const Command& command);
  void UpdateRotation();
  void StartMove(const Command& command);
  void UpdateMove();
  void UpdateGrasp();
  /// Opens the hand: a short pull away from the surface, then the open posture.
  void UpdateRelease();
  void AddReleasePull();

  // judge.cc: what is watched, and what the truth says of it
  void LookAtTruth();
  void WatchContacts();
  void WatchDrop();
  double TruePhi();
  void JudgeExplorationEnd();
  /// The truth about the rotation so far, every tick so that no turn is missed.
  void JudgeRotation();
  void JudgeMove();
  double TruePhiOf(int finger);
  void ReportGait();

  // snapshot.cc: what leaves the session
  FingerRole RoleOf(int finger) const;
  void Snapshot(Frame* frame) const;
  std::uint64_t Hash() const;

  SessionConfig config;
  const HandModel& hand;
  double dt;
  Parameters parameters;
  NoiseLevels noise;
  std::uint64_t seed = 0;
  std::shared_ptr<const ObjectModel> object;
  std::unique_ptr<World> world;
  std::unique_ptr<Sensors> sensors, judge_sensors;
  const SensorReading* reading = nullptr;
  StateEstimator estimator;  // what the controller believes
  StateEstimator judge;      // the same from noise-free readings, never seen by the controller
  FeltSurface felt;
  HybridController controller;
  GraspSequence grasp;
  FingerExploration exploration;
  FingerExploration::Request explore_request;  // of the exploration that runs or waits for room
  FingerGait gait;
  ObjectMove move;
  ObjectMotion motion;
  RegraspRecord regrasp;  // the last one
  // True pose when the rotation or the move began.
  Vector3d p_WO_start = Vector3d::Zero();
  Quaterniond q_WO_start = Quaterniond::Identity();
  QualityMonitor monitor;
  FingerTasks tasks;
  JointVector q_open, q_closed, torque;
  std::int64_t tick = 0, push_until = -1, release_tick = -1;
  int drop_ticks = 0;
  SessionState state = SessionState::kIdle;
  char refusal_text[128] = {};
  JobRecord job;
  Vector3d p_path = Vector3d::Zero();
  std::array<bool, kMaxFingers> was_in_contact{};
  FixedVector<Event, kMaxPending> events, events_out;
  FixedVector<JobRecord, kMaxPending> finished, finished_out;
  bool measure = false;
  StageTimes times;
};

}  // namespace regrasp
