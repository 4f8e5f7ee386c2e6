#pragma once

#include "core/exploration/criterion.h"
#include "core/exploration/exploration_parameters.h"

namespace regrasp {

/// What a regrasping finger looks for (values of gait.mode).
enum class GaitMode : int {
  kExploring = 0,  ///< the paper's: a better contact, by Algorithm 1
  kReturning = 1,  ///< its first contact
};
inline constexpr std::array<std::string_view, 2> kGaitModeNames = {"exploring", "returning"};

/// Which fingers of an exploring gait explore when they regrasp (values of gait.explore).
enum class GaitExplore : int {
  kNever = 0,    ///< none
  kUnknown = 1,  ///< where the surface is not known yet, or its last explorations gained enough
  kAlways = 2,   ///< every one
};
inline constexpr std::array<std::string_view, 3> kGaitExploreNames = {"never", "unknown", "always"};

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
  bool map = true;       ///< plan: what was felt is kept, else only the present contacts are known
  bool whole_stance = true;  ///< plan: the others' contacts are planned together for a refused one
  bool forgive = true;       ///< the reference follows an error that lasts
  double reserve_wanted = 0.6;  ///< plan: motion reserve that counts in full [rad]
  double doubt =
      0.25;  ///< of the spread of felt normals about a contact: its normal may be so far off
  double careful_s =
      0.1;  ///< plan: load transfer where the margin without the finger is scarce [s]
  double friction_share = 0.85;  ///< plan: of the friction felt that is counted on; 0: none is felt
  int rubs = 3;                  ///< plan: so many leaving fingers slide first, to feel it
  double rub_s = 0.25;           ///< ... each for so long [s]
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
  // Meanwhile, while a finger regrasps (turn_along.h).
  double along_speed = 0.35;         ///< highest speed of the object; 0: it rests [rad/s]
  double along_explore_speed = 0.1;  ///< the same while the finger explores [rad/s]
  double along_ahead_s = 0.5;        ///< no faster than the others can follow for so long [s]
  double along_margin = 1.3;  ///< load margin of those that hold from which on it goes at full [N]
  // When a finger may leave.
  double margin_min = 0.25;  ///< rho_min: least load margin of the grasp without it [N]
  double margin_wanted =
      0.80;  ///< below it contacts are sought that allow more without the opposing finger [N]
  double max_shift = 0.006;       ///< ... so far from the present ones [m]
  double skip_distance = 0.0012;  ///< a finger this near to its target stays [m]
  // Leaving and coming back.
  double grip_force = 2.0;     ///< preferred normal force of a holding finger, in `move` too [N]
  double opposing_grip = 3.0;  ///< of the others while the opposing finger regrasps, if larger [N]
  double opposing_friction = 0.6;  ///< ... where so much friction is counted on, at least
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
  GaitExplore explore = GaitExplore::kAlways;
  Criterion criterion = Criterion::kSwitched;  ///< of all but the finger before the opposing one
  double explore_unknown = 0.12;  ///< unknown: from this angle to what was felt on [rad]
  double explore_gain = 0.02;     ///< ... or from this gain of its last explorations on
  double disc_radius =
      0.004;               ///< contacts stay within this distance of the first one, in the palm [m]
  double explore_s = 0.3;  ///< longest exploration per regrasp [s]
  double explore_settle_s = 0.08;  ///< rest before it, until the filters follow
  double return_limit_s = 0.6;     ///< longest way to its last end, and to the best contact
  Estimator estimator = kDefaultEstimator;  ///< of its gradient
  // Choosing, giving up, recovering; each row's meaning in full: core/session/parameters.cc.
  double recover_limit_s = 2.0;  ///< a broken-off regrasp is followed by at most so long a hold [s]
  double recovered = 0.5;        ///< ... which ends below this share of the abort limits
  double second_thought_s = 0.3;  ///< a refusal stands when the margin has been low so long [s]
  double finish_s = 0.4;          ///< rest at the end of a rotation [s]
  double progress = 0.02;         ///< a cycle that turns the object less has not turned it [rad]
  int idle_cycles = 3;            ///< by the table: such cycles in a row before it gives up
  int patience = 20;              ///< the same with planned landings
  int dare_cycles = 1;  ///< plan: after so many (the first round, at rest, is one) felt friction
                        ///< counts beyond control.feel_most
  int misses = 15;      ///< ... and landings in a row that found no surface
  double lead_max =
      0.35;  ///< most that a target is turned back beyond `lead` for a finger at its limit [rad]
  double found_share = 0.5;   ///< weight of the newest exploration's end
  double disc_inside = 0.9;   ///< what is remembered lies within this share of the disc
  double disc_full = 0.5;     ///< the whole disc is free from this share of margin_wanted on
  double want_more = 1.5;     ///< a refused opposing finger: more margin is sought by this factor
  double plan_reach = 0.010;  ///< candidates for a landing lie so far about home [m]
  double room_reach = 0.015;  ///< ... to make room for a refused finger [m]
  double room_gain = 0.05;    ///< load margin for which a finger makes room [N]
  double reserve_needed =
      0.3;  ///< a refused finger with as much motion reserve may stay behind [rad]
  double stance_reach = 0.015;  ///< a planned stance lies so far from the present one [m]
  double steady_s = 0.04;       ///< a finger that has touched so long stands [s]
  double away_s = 0.1;          ///< one that has not for so long is not counted on [s]
  double leave_share = 0.4;    ///< while a finger leaves, this share of the abort limits breaks off
  double margin_least = 0.02;  ///< margin_min after many cycles without progress [N]
  double worth = 0.05;         ///< gain in score for which a finger leaves
  double worth_scarce = 0.4;   ///< ... more of it where the margin without it is 0
  double slip_s =
      0.004;  ///< another finger without contact for so long: the load transfer failed [s]
  double caution = 0.2;       ///< more load margin asked for after that [N]
  double caution_kept = 0.5;  ///< share of it that a good regrasp leaves
  double still_s = 1.0;  ///< an object that has rested so long may be forgiven at any margin [s]
  double still_position = 0.001;      ///< ... which it has if it moved less than this [m]
  double still_rotation = 0.1;        ///< ... and turned less than this [rad]
  double forgive_margin = 0.3;        ///< otherwise with this load margin only [N]
  double forgive_position = 0.001;    ///< so much of an error stays in the reference [m]
  double forgive_rotation = 0.07;     ///< ... and so much of its rotation [rad]
  double win_back_rotation = 0.12;    ///< tilt won back in a motion, at most [rad]
  double win_back_position = 0.0025;  ///< place won back in a motion, at most [m]
  double margin_counts = 0.2;  ///< planned: from this share of a motion on a low margin ends it
  double margin_share = 0.25;  ///< ... low: below this share of margin_min
  double stuck_s = 0.5;        ///< a motion ends after waiting so long for the object [s]
  double stuck_yielding_s =
      1.0;  ///< the same in `move`: a finger that begins to slip takes its time [s]
  double limit_rate =
      0.3;  ///< a joint slower than this does not run into its limit [rad per rad of the object]
  double limit_rate_shift = 12.0;  ///< the same for a shift [rad/m]: equal at 25 mm from the axis
  double yielding_cap = 2.0;  ///< force of a finger that found no room, at most, in slide_force
  double rest_s = 0.4;        ///< move: rest until the object has caught up [s]
  // Hop over the felt surface (hop.h).
  double there_on_object = 0.0005;  ///< a target on the object is reached this near [m]
  double air_limit_s = 1.0;         ///< the finger comes down anyway after so long
  double clear_share = 0.8;         ///< of the lift: it crosses so far above the surface
  double least_slope = 0.5;         ///< n . d: a steeper surface counts as at this slope
  double rise_most = 0.010;         ///< ... and lifts it by at most so much more [m]
  double seek_way = 0.025;          ///< it looks so far inwards for a surface it has missed [m]
  // Planning a landing (landing_plan.h) ...
  double landing_limit_margin = 0.05;  ///< of a joint there [rad]
  double landing_missing = 0.0015;     ///< a tip this far from its target does not reach it [m]
  double landing_far = 0.010;          ///< distance from home that costs landing_far_cost [m]
  double landing_far_cost = 0.3;       ///< in score
  double landing_clearance = 0.001;    ///< to other fingers [m]
  double landing_overlap = 0.0005;     ///< with one of them: the finger does not get there [m]
  double landing_known = 0.35;         ///< farther from what was felt is unknown [rad]
  double landing_unknown_cost = 1.0;   ///< in score per rad from what was felt
  double landing_unknown_share = 0.3;  ///< of that angle: so far its normal may be off
  double landing_penalty = 2.0;        ///< in score; where it is used: landing_plan.h
  double link_clearance = 0.002;       ///< of the link before the tip from the object [m]
  double link_touches = 0.004;         ///< so much less costs landing_penalty [m]
  // ... and a stance (stance_plan.h, stance_search.h).
  int stance_trials = 400;            ///< of a plan
  double stance_step = 0.003;         ///< standard deviation of a trial's step, per axis [m]
  double stance_moves = 0.6;          ///< share of the contacts that a trial moves
  double stance_unknown = 0.25;       ///< no contact farther from what was felt [rad]
  double stance_limit_margin = 0.03;  ///< of a joint there [rad]
  int search_trials = 300;            ///< by the table: stances looked at
  double search_interval_s = 0.005;   ///< ... one in so long
  double search_step = 0.0015;        ///< ... standard deviation of its step, per axis [m]
};

}  // namespace regrasp
