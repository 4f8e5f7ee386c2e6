#pragma once

/// Records of long-running work. Plain data of fixed size, so that they travel in frames.

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/session/command.h"

namespace regrasp {

enum class JobMethod : std::uint8_t { kGrasp, kRelease, kExplore, kRotate, kMove, kStep, kRestore };
enum class JobState : std::uint8_t { kQueued, kRunning, kDone, kFailed, kCancelled };
/// Why an exploration ended.
enum class ExploreReason : std::uint8_t {
  kNone,
  kGradient,
  kMaxCycles,
  kContactLost,
  kDropped,
  kCancelled,
  kObjectMoved,  ///< the other fingers could not carry what the finger dragged
};

/// Why a move ended.
enum class MoveEnd : std::uint8_t {
  kNone,
  kReached,
  kJointLimit,      ///< a finger's joint came to its limit
  kObjectStuck,     ///< the object did not follow
  kManipulability,  ///< a finger came near a singular posture
  kExcursion,       ///< a contact was too far from its first place in the palm
  kLoadMargin,      ///< the grasp could hardly carry more
  kStopped,
  kDropped,
};

/// The job that a command starts, or nothing for a command that starts none.
std::optional<JobMethod> JobMethodOf(CommandType type);
std::string_view Name(JobMethod method);      ///< "grasp", ...
std::string_view Name(JobState state);        ///< "queued", ...
std::string_view Name(ExploreReason reason);  ///< "gradient", "max_cycles", ...; "" for kNone
std::string_view Name(MoveEnd end);           ///< "reached", "joint_limit", ...; "" for kNone

struct ExploreResult {
  int finger = -1;
  Criterion criterion = Criterion::kManipulability;
  Estimator estimator = Estimator::kLeastSquares;
  bool converged = false;
  ExploreReason reason = ExploreReason::kNone;
  int cycles = 0;                         ///< i of Algorithm 1
  double phi_initial = 0, phi_final = 0;  ///< as the controller saw it (see Objective)
  double phi_true_initial = 0,
         phi_true_final = 0;  ///< noise-free, from the simulator, for judging only
  double path_length_m = 0;   ///< of the true contact point over the object
  std::uint64_t seed = 0;
};

struct RotateResult {
  double angle_rad = 0;  ///< signed, unwrapped, true object rotation about the axis
  double turns = 0;
  int gait_cycles = 0;
  int regrasps = 0;
  bool dropped = false;
  double max_position_error_m = 0;
  double max_tilt_rad = 0;
  double sim_time_s = 0;
};

/// What was wanted, and what became of it by the truth (noise-free, from the simulator, for judging
/// only). Offsets of the object's centre and rotation vectors in W, from where the move began.
struct MoveResult {
  Vector3d offset_m = Vector3d::Zero(), rotation_rad = Vector3d::Zero();  ///< wanted
  Vector3d achieved_offset_m = Vector3d::Zero(), achieved_rotation_rad = Vector3d::Zero();
  bool reached = false;  ///< the reference went all the way
  MoveEnd end = MoveEnd::kNone;
  int end_finger = -1;  ///< the finger that could not go on, or -1
  double max_position_error_m = 0, max_rotation_error_rad = 0;  ///< object against its reference
  double sim_time_s = 0;
};

/// One regrasp of the finger gait, judged by the truth (noise-free phi; stability or
/// manipulability, whichever was the objective).
struct RegraspRecord {
  int finger = -1;
  Criterion criterion = Criterion::kManipulability;
  bool on_stability = false;  ///< `switched`: stability was the objective at the end
  bool aborted = false;
  double phi_before = 0;  ///< before the finger left
  double phi_start = 0;   ///< where Algorithm 1 began; phi_before without exploration
  double phi_after = 0;   ///< when the finger was back in the grasp
};

struct JobRecord {
  std::int64_t id = 0;
  JobMethod method = JobMethod::kGrasp;
  JobState state = JobState::kQueued;
  char error[160] = {};          ///< empty unless failed
  double progress = 0;           ///< 0 .. 1
  std::int64_t start_tick = -1;  ///< tick at which the command was applied
  std::int64_t end_tick = -1;
  ExploreResult explore;  ///< method explore only
  RotateResult rotate;    ///< method rotate only
  MoveResult move;        ///< method move only
};

}  // namespace regrasp
