#pragma once

/// One tick's worth of everything that leaves the session: for status, streams, pictures and logs.
/// Trivially copyable, no pointers.

#include <array>
#include <cmath>
#include <cstdint>

#include "core/common/fixed_vector.h"
#include "core/common/frames.h"
#include "core/common/limits.h"
#include "core/quality/measures.h"
#include "core/sensing/noise.h"
#include "core/session/job.h"

namespace regrasp {

enum class FingerRole : std::uint8_t { kFree, kHold, kExplore, kMove };

std::string_view Name(SessionState state);  ///< "idle", ...
std::string_view Name(FingerRole role);     ///< "free", "hold", "explore", "move"
/// Whether the fingers hold the object by themselves. `stand_in`: the stand-in holds it.
bool HoldsAlone(SessionState state, bool stand_in);

/// One finger, in one tick.
struct FingerFrame {
  FingerRole role = FingerRole::kFree;
  // What the controller senses (filtered).
  bool in_contact = false;
  Vector3d p_WC = Vector3d::Zero();         ///< [m]
  Vector3d normal_W = Vector3d::UnitZ();    ///< outward object normal
  double force = 0;                         ///< normal force [N]
  Vector3d f_command_W = Vector3d::Zero();  ///< force on the object that control asks for [N]
  double manipulability = 0;                ///< [kManipulabilityUnit]
  double load_margin_without = 0;           ///< rho of the grasp without this finger [N]
  double joint_limit_margin = 0;            ///< smallest distance of its joints to a limit [rad]
  // Truth, for judging and drawing only.
  bool true_contact = false;
  Vector3d true_p_WC = Vector3d::Zero();
  Vector3d true_normal_W = Vector3d::UnitZ();
  Vector3d true_force_W = Vector3d::Zero();  ///< on the object [N]
  double true_manipulability = 0;            ///< [kManipulabilityUnit]
  Vector3d true_tip_W = Vector3d::Zero();    ///< centre of the fingertip sphere [m]
};

/// Stability of the grasp formed by the holding fingers, from sensed contacts.
struct StabilityFrame {
  Measure measure = Measure::kMinSingularValue;  ///< selected by control.stability_measure
  double active = 0;                             ///< its value
  double threshold = 0;  ///< below it, `switched` maximises stability instead of manipulability
  std::array<double, kNumFrameMeasures> values{};  ///< by Measure
  double load_margin = 0;                          ///< rho of all fingers in contact [N]

  double of(Measure which) const { return values[static_cast<std::size_t>(which)]; }
};

/// State of Algorithm 1 while a finger explores.
struct ExplorationFrame {
  bool active = false;
  int finger = -1;
  Criterion criterion = Criterion::kManipulability;
  bool on_stability = false;  ///< `switched`: stability is the objective at this tick
  int cycle = 0;
  double phi = std::nan("");            ///< NaN until the finger has begun to press
  double gradient_norm = std::nan("");  ///< |P R_WCᵀ grad phi| [1/m]; NaN before the first cycle
  double epsilon = 0;                   ///< its threshold [1/m]
  Vector3d gradient_W = Vector3d::Zero();
  Vector3d velocity_W = Vector3d::Zero();  ///< wanted velocity of the contact, line 11 [m/s]
};

/// Finger gait, while rotating.
struct GaitFrame {
  bool active = false;
  int phase = 0;        ///< GaitPhase
  int finger = -1;      ///< the finger that regrasps, -1 during object motion
  char state[24] = {};  ///< row of the gait table: "S_T", ..., "object motion" while all hold
  double reference_angle_rad = 0;  ///< of the object's reference so far
  double target_angle_rad = 0;     ///< equal to it; kept for scripts
  double achieved_angle_rad = 0;   ///< of the object, by the truth
  int cycles = 0, regrasps = 0;
};

enum class EventKind : std::uint8_t {
  kState,  ///< value = SessionState entered
  kJobStarted,
  kJobFinished,  ///< value = job id
  kContactLost,
  kContactMade,  ///< finger
  kCriterion,    ///< value = 1: stability became the objective, 0: manipulability
  kDropped,
  kFault,
  kGaitPhase,
  kRefused,
  kSlip,
  kNoise,
  kParameter,
  kPush,
  kReset,
  kStandIn,
  kRegrasp,
  kFriction,  ///< felt by sliding fingers; value = |f_t| / f_n
};
std::string_view Name(EventKind kind);  ///< "state", "job_started", ...

struct Event {
  std::int64_t tick = 0;
  EventKind kind = EventKind::kState;
  int finger = -1;
  double value = 0;
  /// kRegrasp of a finger that explored by manipulability: noise-free objective where it began to
  /// explore (`value` is that at its end); else 0.
  double from = 0;
  char text[kEventRoom] = {};  ///< one plain sentence
};

struct Frame {
  std::int64_t tick = 0;
  double time_s = 0;  ///< tick * dt
  std::uint64_t state_hash =
      0;  ///< of simulation and controller after this tick; 0 when not computed
  SessionState state = SessionState::kIdle;
  std::uint64_t seed = 0;
  NoiseLevels noise;
  bool stand_in = true;  ///< the stand-in holds the object
  int num_fingers = 0;
  FixedVector<FingerFrame, kMaxFingers> fingers;
  JointVector q_sensed, q, qdot, torque;    ///< sensed; true; true; applied [rad, rad, rad/s, N m]
  Vector3d p_WO_sensed = Vector3d::Zero();  ///< filtered
  Quaterniond q_WO_sensed = Quaterniond::Identity();
  Vector3d p_WO = Vector3d::Zero();  ///< truth, as are the next three
  Quaterniond q_WO = Quaterniond::Identity();
  Vector3d v_WO = Vector3d::Zero(), w_WO = Vector3d::Zero();
  Vector3d p_WO_reference = Vector3d::Zero();  ///< where control wants the object
  double mass_kg = 0, friction = 0;
  double friction_counted = 0;  ///< what the controller counts on: felt, or its estimate
  Vector3d gravity_W = Vector3d::Zero();
  struct Contact {
    int link, finger;
    Vector3d p_WC, normal_W, force_W;
    double depth;
  };
  FixedVector<Contact, kMaxObjectContacts> contacts;  ///< truth: every contact of the object
  StabilityFrame stability;
  ExplorationFrame exploration;
  GaitFrame gait;
  JobRecord job;  ///< the current or last job; id 0 = none yet
};

}  // namespace regrasp
