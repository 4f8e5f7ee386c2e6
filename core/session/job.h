#pragma once

/// Records of long-running work. Plain data of fixed size, so that they travel in frames.

#include <cstdint>
#include <string_view>

#include "core/common/fields.h"
#include "core/common/reason.h"
#include "core/session/command.h"

namespace regrasp {

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
  kNoGain,       ///< the best phi met rose too little for exploration.no_gain_s
  kFell,         ///< the search converged, and phi is clearly lower than where it began
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

std::string_view Name(JobMethod method);      ///< "grasp", ...
std::string_view Name(JobState state);        ///< "queued", ...
std::string_view Name(ExploreReason reason);  ///< "gradient", "max_cycles", ...; "" for kNone
std::string_view Name(MoveEnd end);           ///< "reached", "joint_limit", ...; "" for kNone

struct ExploreResult {
  int finger = -1;
  Criterion criterion = Criterion::kManipulability;
  Estimator estimator = kDefaultEstimator;
  bool converged = false;
  ExploreReason reason = ExploreReason::kNone;
  int cycles = 0;                         ///< i of Algorithm 1
  double phi_initial = 0, phi_final = 0;  ///< as the controller saw it (see Objective)
  double phi_true_initial = 0,
         phi_true_final = 0;  ///< noise-free, from the simulator, for judging only
  double path_length_m = 0;   ///< of the true contact point over the object
  std::uint64_t seed = 0;
  template <typename V>
  void Fields(V& v) {
    v("finger", finger, v.Finger());
    v("criterion", criterion, kLastCriterion);
    v("estimator", estimator, kLastEstimator);
    v("converged", converged);
    v("reason", reason, ExploreReason::kFell);
    v("cycles", cycles);
    v("phi_initial", phi_initial);
    v("phi_final", phi_final);
    v("phi_true_initial", phi_true_initial);
    v("phi_true_final", phi_true_final);
    v("path_length_m", path_length_m);
    v("seed", seed);
  }
};

struct RotateResult {
  double angle_rad = 0;  ///< signed, unwrapped, true object rotation about the axis
  double turns = 0;
  int gait_cycles = 0;
  int regrasps = 0;
  bool dropped = false;
  /// Of the object's centre from where the rotation began [m], and of the axis [rad].
  double max_position_error_m = 0;
  double max_tilt_rad = 0;
  double max_lag_m = 0;      ///< of the object's centre from its reference [m]
  int reference_resets = 0;  ///< how often the reference has followed the object
  double sim_time_s = 0;
  template <typename V>
  void Fields(V& v) {
    v("angle_rad", angle_rad);
    v("turns", turns);
    v("gait_cycles", gait_cycles);
    v("regrasps", regrasps);
    v("dropped", dropped);
    v("max_position_error_m", max_position_error_m);
    v("max_tilt_rad", max_tilt_rad);
    v("max_lag_m", max_lag_m);
    v("reference_resets", reference_resets);
    v("sim_time_s", sim_time_s);
  }
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
  template <typename V>
  void Fields(V& v) {
    v("offset_m", offset_m);
    v("rotation_rad", rotation_rad);
    v("achieved_offset_m", achieved_offset_m);
    v("achieved_rotation_rad", achieved_rotation_rad);
    v("reached", reached);
    v("end", end, MoveEnd::kDropped);
    v("end_finger", end_finger, v.Finger());
    v("max_position_error_m", max_position_error_m);
    v("max_rotation_error_rad", max_rotation_error_rad);
    v("sim_time_s", sim_time_s);
  }
};

/// One regrasp of the finger gait, judged by the truth (noise-free phi; stability or
/// manipulability, whichever was the objective).
struct RegraspRecord {
  int finger = -1;
  Criterion criterion = Criterion::kManipulability;
  bool aborted = false;
  double phi_before = 0;  ///< before the finger left
  double phi_start = 0;   ///< where Algorithm 1 began; phi_before without exploration
  double phi_after = 0;   ///< when the finger was back in the grasp
  template <typename V>
  void Fields(V& v) {
    v("finger", finger, v.Finger());
    v("criterion", criterion, kLastCriterion);
    v("aborted", aborted);
    v("phi_before", phi_before);
    v("phi_start", phi_start);
    v("phi_after", phi_after);
  }
};

struct JobRecord {
  std::int64_t id = 0;
  JobMethod method = JobMethod::kGrasp;
  JobState state = JobState::kQueued;
  char error[kReasonRoom] = {};  ///< empty unless failed
  double progress = 0;           ///< 0 .. 1
  std::int64_t start_tick = -1;  ///< tick at which the command was applied
  std::int64_t end_tick = -1;
  ExploreResult explore;  ///< method explore only
  RotateResult rotate;    ///< method rotate only
  MoveResult move;        ///< method move only
  template <typename V>
  void Fields(V& v) {
    if constexpr (!V::kHashes) v("id", id);  // a name: a branch may give it another one
    v("method", method, JobMethod::kRestore);
    v("state", state, JobState::kCancelled);
    v("error", error);
    v("progress", progress);
    v("start_tick", start_tick, kCountOrNone);
    v("end_tick", end_tick, kCountOrNone);
    v("explore", explore);
    v("rotate", rotate);
    v("move", move);
  }
  /// What the record of a job of this method has besides: what the answer of `job.get` shows.
  template <typename V>
  void ResultFields(V& v) {
    if (method == JobMethod::kExplore) explore.Fields(v);
    if (method == JobMethod::kRotate) rotate.Fields(v);
    if (method == JobMethod::kMove) move.Fields(v);
  }
};

}  // namespace regrasp
