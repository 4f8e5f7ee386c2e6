#pragma once

/// The jobs that commands start: what each takes and answers. One row per row of the table of jobs
/// (core/session/job_table.h).

#include <array>
#include <numbers>

#include "core/exploration/criterion.h"
#include "core/exploration/estimator.h"
#include "core/protocol/methods.h"

namespace regrasp::rows {

using enum ParamType;

inline constexpr std::array kExplore = {
    ParamSpec{.name = "finger",
              .type = kEnum,
              .sentence = "the finger that explores",
              .required = true,
              .names = NameSource::kFinger},
    ParamSpec{.name = "criterion",
              .type = kEnum,
              .sentence = "what it maximises",
              .values = kCriterionNames,
              .default_text = "manipulability"},
    ParamSpec{.name = "estimator",
              .type = kEnum,
              .sentence = "how it estimates the gradient; secant is the rule as printed",
              .values = kOfferedEstimators,
              .default_text = Name(kDefaultEstimator)},
    ParamSpec{.name = "seed",
              .type = kInteger,
              .sentence = "seed of the random start direction",
              .min = 0,
              .max = kMaxSafeInteger,
              .default_text = "the seed of the run"},
    ParamSpec{.name = "max_cycles",
              .type = kInteger,
              .sentence = "give up after so many cycles",
              .min = 1,
              .max = 1e6,
              .default_text = "parameter exploration.max_cycles"},
};
inline constexpr std::array kMove = {
    ParamSpec{.name = "offset_m",
              .type = kVector3,
              .sentence = "shift of the object's centre, in W; its length is at most 0.05 m",
              .unit = "m",
              .min = -kMaxMoveOffset,
              .max = kMaxMoveOffset,
              .default_text = "[0, 0, 0]"},
    ParamSpec{.name = "rotation_rad",
              .type = kVector3,
              .sentence = "turn of the object, a rotation vector in W; its length is at most pi",
              .unit = "rad",
              .min = -std::numbers::pi,
              .max = std::numbers::pi,
              .default_text = "[0, 0, 0]"},
};
inline constexpr std::array kRotate = {
    ParamSpec{.name = "angle_rad",
              .sentence = "turn by this angle, signed; or give turns or continuous",
              .unit = "rad",
              .min = -1e4,
              .max = 1e4,
              .default_text = "not used"},
    ParamSpec{.name = "turns",
              .sentence = "turn so many times, signed",
              .min = -1000,
              .max = 1000,
              .default_text = "not used"},
    ParamSpec{.name = "continuous",
              .type = kBool,
              .sentence = "turn until stopped",
              .default_text = "false"},
    ParamSpec{.name = "axis",
              .type = kVector3,
              .sentence = "direction in W about which the object turns; any length but zero",
              .min = -1e6,
              .max = 1e6,
              .default_text = "[0, 0, 1]"},
    ParamSpec{.name = "speed_rad_s",
              .sentence = "speed of the object while it moves",
              .unit = "rad/s",
              .min = 0.001,
              .max = 10,
              .default_text = "parameter gait.speed_rad_s"},
};

inline constexpr std::array kJobRows = {
    MethodSpec{"grasp", "grasp", "close the hand on the object and hold it", {}, true, "job"},
    MethodSpec{"release", "release", "open the hand", {}, true, "job"},
    MethodSpec{
        "rotate", "rotate", "turn the object in the hand by finger gaiting", kRotate, true,
        "job; its record: angle_rad (signed, unwrapped, true), turns, "
        "gait_cycles, regrasps, dropped, max_position_error_m (of the object's centre from where "
        "it began), max_tilt_rad (of the axis), max_lag_m (behind its reference), "
        "reference_resets (times the reference followed the object), sim_time_s; failed where it "
        "ends by itself and the object has truly not turned as asked, within 5 degrees"},
    MethodSpec{
        "move", "move", "move the object a little with all fingers, without a regrasp", kMove, true,
        "job; its record: offset_m[3], rotation_rad[3] (wanted), achieved_offset_m[3], "
        "achieved_rotation_rad[3], reached, end (reached, joint_limit, object_stuck, "
        "manipulability, excursion, load_margin, stopped, dropped; null while it moves, and "
        "where it never moved or the simulation faulted), end_finger (whose limit it was, or "
        "null), max_position_error_m, max_rotation_error_rad (object against its reference), "
        "sim_time_s; what was achieved and the errors are noise-free, from the simulator"},
    MethodSpec{"explore", "explore", "improve the grasp by sliding one finger over the surface",
               kExplore, true,
               "job; its record: finger, criterion, estimator, seed, converged, reason (gradient, "
               "max_cycles, contact_lost, dropped, cancelled, object_moved, no_gain, fell (it "
               "converged, but phi is "
               "more than 2 % lower than where it began); null until it has ended), cycles, "
               "phi_initial, phi_final, phi_true_initial, phi_true_final "
               "(noise-free, from the simulator, for judging only, at the ends of the slide; the "
               "held grasp "
               "after it, which `truth` and the picture `comparison` tell, has another phi; null "
               "until they are "
               "known), path_length_m"},
};

}  // namespace regrasp::rows
