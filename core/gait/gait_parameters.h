#pragma once

#include "core/exploration/exploration_parameters.h"

namespace regrasp {

/// What a regrasping finger looks for (values of gait.mode).
enum class GaitMode : int {
  kExploring = 0,  ///< the paper's: a better contact, by Algorithm 1
  kReturning = 1,  ///< its first contact
};
inline constexpr std::array<std::string_view, 2> kGaitModeNames = {"exploring", "returning"};

/// Whole sets of gait parameters (values of gait.preset).
enum class GaitPreset : int {
  kPlanned = 0,  ///< the default: landings planned on the felt surface
  kPaper = 1,    ///< the paper's: fingers explore about their first contacts, nothing is planned
};
inline constexpr std::array<std::string_view, 2> kGaitPresetNames = {"planned", "paper"};

/// Constants of the local manipulation controller and the finger gait. Unit, range and source of
/// each stand in the parameter table (core/session/parameters.cc).
struct GaitParameters {
  GaitPreset preset = GaitPreset::kPlanned;  ///< the last one taken; what it sets may be changed
  GaitMode mode = GaitMode::kReturning;
  bool by_need = false;  ///< the finger farthest from its target first, else the order of the table
  bool hop = true;       ///< a finger hops to its target, else it slides
  bool plan = true;      ///< landings are planned on the felt surface, else at the first contacts
  bool forgive = true;   ///< the reference follows an error that lasts
  double reserve_wanted = 0.6;  ///< plan: motion reserve that counts in full [rad]
  double doubt =
      0.5;  ///< of the spread of felt normals about a contact: its normal may be so far off
  double careful_s =
      0.1;  ///< plan: load transfer where the margin without the finger is scarce [s]
  // Object motion.
  double speed_rad_s = 0.3490658504;  ///< object speed during its motion phase (20 deg/s)
  double move_speed = 0.010;          ///< object speed along a shift [m/s]
  double acceleration = 8.0;          ///< of that speed [rad/s²]
  double step_rad = 0.3490658504;     ///< object motion between regrasps (20 deg)
  double settle_s = 0.05;             ///< after it, before the first finger leaves
  double limit_margin = 0.03;         ///< the motion ends with a joint this near to its limit [rad]
  double min_manipulability =
      0.25;  ///< ... with a finger below this share of its first manipulability
  double max_excursion =
      0.035;  ///< ... with a contact this far from its first place in the palm [m]
  double lag_position = 0.002;  ///< the reference waits while the object is this far behind [m]
  double lag_rotation = 0.12;   ///< ... or so much [rad]
  // When a finger may leave.
  double margin_min = 0.25;  ///< rho_min: least load margin of the grasp without it [N]
  double margin_wanted =
      0.80;  ///< below it contacts are sought that allow more without the opposing finger [N]
  double max_shift = 0.006;       ///< ... so far from the present ones [m]
  double skip_distance = 0.0012;  ///< a finger this near to its target stays [m]
  // Leaving and coming back.
  double grip_force = 2.0;     ///< preferred normal force of a holding finger, in `move` too [N]
  double transfer_s = 0.03;    ///< load transfer before a finger leaves, and after it is back [s]
  double hop_force = 0.05;     ///< its force when it leaves [N]
  double lift_height = 0.003;  ///< along the outward normal [m]
  double lift_speed = 0.10;    ///< [m/s]
  double across_speed = 0.15;  ///< [m/s]
  double down_speed = 0.05;    ///< [m/s]
  double slide_force = 0.3;    ///< normal force of a sliding finger [N]
  double slide_gain = 8.0;     ///< sliding speed per distance [1/s]
  double slide_speed = 0.015;  ///< highest [m/s]
  double slide_arrived = 0.0005;  ///< ... which ends this near [m]
  double slide_limit_s = 2.5;     ///< ... or after so long
  double touch_s = 0.003;         ///< a landing counts after so long in contact
  double land_distance = 0.0015;  ///< this near to above the target the finger comes down [m]
  double land_late_s = 0.15;      ///< it comes down anyway so long after its target got there
  double land_depth = 0.010;      ///< so far below where it left there is no surface [m]
  double clear_distance = 0.001;  ///< above the surface, after so far a touch is an obstacle [m]
  double lead = 0.5;              ///< target ahead of the first contact, in shares of the next step
  // Disturbances.
  double abort_position = 0.003;         ///< object error at which a regrasp is broken off [m]
  double abort_rotation = 0.2094395102;  ///< (12 deg)
  // Exploring.
  double disc_radius =
      0.004;               ///< contacts stay within this distance of the first one, in the palm [m]
  double explore_s = 0.5;  ///< longest exploration per regrasp [s]
  double explore_settle_s = 0.08;  ///< rest before it, until the filters follow
  double return_limit_s = 0.6;     ///< longest way to its last end, and to the best contact
  Estimator estimator = Estimator::kLeastSquares;  ///< of its gradient
};

}  // namespace regrasp
