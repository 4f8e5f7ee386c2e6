#pragma once

/// The whole product without threads, sockets or clocks: simulation, sensors, controller,
/// exploration, gait. The daemon adds pacing and sockets; tests and batch runs call Tick() directly
/// and see the same bits. Same build, configuration, seed and (tick, command) list give the same
/// states. A session is one run: a reset is a new session.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/hand/scenario.h"
#include "core/session/command.h"
#include "core/session/frame.h"
#include "core/session/job.h"
#include "core/session/parameters.h"
#include "core/shape/felt_surface.h"
#include "core/world/world.h"

namespace regrasp {

struct SessionConfig {
  LoadedScenario model;
  Parameters parameters;
  NoiseLevels noise;
  std::uint64_t seed = 1;
  WorldConfig world;
};

/// Whether a command may be given in this state; used by the daemon before it accepts, and again by
/// the session when it applies.
struct Verdict {
  enum class Kind { kAllowed, kBusy, kBadState } kind = Kind::kAllowed;
  const char* reason = "";  ///< cause, lower case, no full stop
  const char* hint = "";    ///< the next command to try
};
Verdict Check(CommandType type, SessionState state, bool job_running);

/// Whether a job can run with these parameters: where it maximises stability, the selected measure
/// must be fit for a tick. `criterion`: of an explore job.
Verdict CheckMeasure(const Parameters& parameters, JobMethod method, Criterion criterion);

class Session {
 public:
  /// Builds the world at tick 0, state idle. Throws ModelError when model and scenario do not fit.
  explicit Session(SessionConfig config);
  ~Session();

  /// Applies a command before the next tick. A refused job command becomes a failed job whose error
  /// says why; other refused commands change nothing. Returns the verdict.
  Verdict Apply(const Command& command);

  /// One dt: sense -> kinematics -> quality -> gait -> exploration | manipulation -> contact forces
  /// (QP)
  /// -> joint torques -> step world. Never throws, allocates, locks, logs or reads a clock (unless
  /// MeasureStages is on). In state faulted only the tick count advances.
  void Tick();

  std::int64_t tick() const;
  SessionState state() const;
  bool job_running() const;
  const SessionConfig& config() const;  ///< as constructed; live values are in parameters()
  const Parameters& parameters() const;
  const NoiseLevels& noise() const;
  std::uint64_t seed() const;

  /// Copies the newest frame. `with_hash` also fills Frame::state_hash.
  void Snapshot(Frame* frame, bool with_hash) const;
  /// 64-bit hash over world, sensors and controller.
  std::uint64_t StateHash() const;
  /// Appends every number that decides what comes next, in a form of this build (see
  /// journal/saved_state.h). Not in state faulted: the world is out of order then.
  void Save(std::string* state) const;
  /// Goes on from what Save() wrote, in a session of the same configuration. Throws StateError at
  /// the first number that cannot be; the session must be thrown away then. Events and ended jobs
  /// that wait are forgotten.
  void Load(std::string_view state);
  /// Events since the last call, oldest first; at most 64 are kept per call, older ones are
  /// dropped. The span is valid until the next Tick() or Apply().
  std::span<const Event> TakeEvents();
  /// Jobs that ended since the last call, oldest first; same rules.
  std::span<const JobRecord> TakeFinishedJobs();

  /// Seconds of the last tick by stage; zeros unless on.
  struct StageTimes {
    double sense_s = 0, control_s = 0, collide_s = 0, step_s = 0;
  };
  void MeasureStages(bool on);
  StageTimes stage_times() const;

  /// The object's surface as felt since the last reset, by what the controller believes.
  const FeltSurface& felt_surface() const;

  /// For tests and judges: the truth.
  const WorldState& truth() const;
  const World& world() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace regrasp
