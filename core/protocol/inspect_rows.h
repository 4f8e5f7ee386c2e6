#pragma once

/// What a client asks the daemon, about itself, its jobs and its hand.

#include <array>
#include <string_view>

#include "core/protocol/methods.h"

namespace regrasp::rows {

using enum ParamType;

inline constexpr std::array<std::string_view, 6> kTopics = {"contacts", "events", "joints",
                                                            "quality",  "status", "truth"};
inline constexpr std::array kDescribe = {
    ParamSpec{.name = "method",
              .type = kString,
              .sentence = "only this method",
              .default_text = "all methods"},
};
inline constexpr std::array kEvents = {
    ParamSpec{.name = "count",
              .type = kInteger,
              .sentence = "at most so many, the newest",
              .min = 1,
              .max = 1000,
              .default_text = "100"},
};
inline constexpr std::array kHello = {
    ParamSpec{.name = "protocol",
              .type = kIntegerPair,
              .sentence = "lowest and highest version the client speaks",
              .required = true,
              .min = 0,
              .max = 1e6},
};
inline constexpr ParamSpec kOneJob = {.name = "id",
                                      .type = kInteger,
                                      .sentence = "number of the job",
                                      .required = true,
                                      .min = 1,
                                      .max = kMaxSafeInteger};
inline constexpr std::array kJobId = {kOneJob};
inline constexpr std::array kJobWait = {
    kOneJob,
    ParamSpec{.name = "timeout_s",
              .type = kNumber,
              .sentence = "answer with error -32004 after so long (wall clock)",
              .unit = "s",
              .min = 0,
              .max = 1e6,
              .default_text = "no limit"},
};
inline constexpr std::string_view kQualityMeasures[] = {"all", "frame"};
inline constexpr std::array kQuality = {
    ParamSpec{.name = "measures",
              .type = kEnum,
              .sentence = "all, or frame: only those that every frame has, for who asks often",
              .values = kQualityMeasures,
              .default_text = "all"},
};
inline constexpr std::array kShape = {
    ParamSpec{.name = "mesh",
              .type = kBool,
              .sentence = "also the surface as a closed mesh, in the object's frame",
              .default_text = "false"},
};
inline constexpr std::array kSubscribe = {
    ParamSpec{.name = "topic",
              .type = kEnum,
              .sentence = "what to send",
              .required = true,
              .values = kTopics},
    ParamSpec{.name = "rate_hz",
              .sentence = "samples per second of wall clock; events come at once",
              .unit = "Hz",
              .min = 0.1,
              .max = 100,
              .default_text = "10"},
};
inline constexpr std::array kUnsubscribe = {
    ParamSpec{.name = "sub",
              .type = kInteger,
              .sentence = "number of the subscription",
              .required = true,
              .min = 1,
              .max = kMaxSafeInteger},
};

inline constexpr std::array kInspectRows = {
    MethodSpec{
        "contacts",
        "contacts",
        "what the controller senses at each fingertip",
        {},
        false,
        "tick, time_s, object: {p_WO_m, q_WO_wxyz, p_WO_reference_m (where control wants it)}, "
        "normals: outward (out of the object), friction, weight_n, max_force_n (what the "
        "controller reckons with), fingers: {NAME: {role, in_contact, p_WC_m, normal_W, force_n, "
        "force_command_W_n}}; p_WC_m and normal_W are null without contact, p_WO_reference_m until "
        "the "
        "hand alone holds the object; evaluate takes this answer as it is"},
    MethodSpec{"describe", "call describe",
               "every method with its parameters, types, units and ranges", kDescribe, false,
               "version, protocol, methods, errors"},
    MethodSpec{"events", "events", "the latest events", kEvents, false,
               "events: [{tick, t_s, kind, finger, text, ...}], oldest first; dropped"},
    MethodSpec{"hello", "call hello", "agree on a protocol version (optional)", kHello, false,
               "protocol, version, server"},
    MethodSpec{"identity",
               "call identity",
               "what decides the results, besides seed and commands: equal answers, equal bits",
               {},
               false,
               "build; stepper; models: {scenario, hand, object}, each {name, hash of the model as "
               "it was read}; parameters: {NAME: value} of those that differ from their defaults"},
    MethodSpec{"job.cancel", "job cancel", "end a job", kJobId, false, "the record of the job"},
    MethodSpec{"job.get", "job show", "the record of a job", kJobId, false,
               "the record of the job"},
    MethodSpec{
        "job.list", "job list", "the last 256 jobs, oldest first", {}, false, "jobs: [record]"},
    MethodSpec{"job.wait", "job wait", "wait until a job has ended; the only deferred answer",
               kJobWait, false, "the record of the job"},
    MethodSpec{
        "joints",
        "joints",
        "joint angles, torques and limits",
        {},
        false,
        "tick, time_s, joints: [{name, finger, angle_rad, torque_nm, lower_rad, upper_rad}]"},
    MethodSpec{
        "quality", "quality", "quality of the grasp", kQuality, false,
        "tick, time_s, criterion, stability, stability_measure, threshold, load_margin_n, "
        "measures: [NAME] and the value of each by its name, torque_scale_m "
        "(mean distance of the contacts from the object's centre; torques are divided by "
        "it), fingers: {NAME: {manipulability, load_margin_without_n, "
        "joint_limit_margin_rad}}, exploration (null, or of the one that runs: finger, criterion, "
        "cycle, phi, gradient_norm_1_m, gradient_threshold_1_m); measures "
        "and margins are null while no finger that holds is in contact"},
    MethodSpec{"shape", "shape", "the object's surface as the fingers have felt it", kShape, false,
               "tick, time_s, object, touched_fraction (of all directions), touched_cells, cells, "
               "mean_radius_m, truth (for judging; null before anything was felt well: cells, "
               "rms_error_m, mean_error_m (bias, positive outside), normal_error_rad (median)), "
               "mesh: {vertices_O_m, normals_O, unknown_rad (angle to the nearest felt "
               "direction), error_m (to the true surface), triangles}"},
    MethodSpec{
        "shutdown",
        "down",
        "stop the daemon cleanly",
        {},
        false,
        "stopping, activated (true: the service manager starts another at the next connection)"},
    MethodSpec{"status",
               "status",
               "state of daemon and simulation",
               {},
               false,
               "version, protocol, state, paused, clock (continuous, lockstep), "
               "advancing (time goes on now), tick, time_s, state_hash, "
               "real_time_factor (0 while time stands still, null where it is not known yet), "
               "speed, stepper, stepper_reason, tick_p99_s, seed, hand, object, warnings, job, "
               "gait: {active, "
               "phase, finger, state, "
               "reference_angle_rad, target_angle_rad (equal to it, kept for scripts), "
               "achieved_angle_rad, cycles, regrasps}, "
               "incident (the last drop: "
               "tick, cause, record, "
               "picture; or null), noise, clients, ..."},
    MethodSpec{"subscribe", "watch", "receive a topic as notifications", kSubscribe, false, "sub"},
    MethodSpec{"truth",
               "truth",
               "what only the simulator knows",
               {},
               false,
               "tick, time_s, object {p_WO_m, q_WO_wxyz, v_m_s, w_rad_s, mass_kg, friction}, "
               "contacts [{link, finger, p_WC_m, normal_W, force_W_n, depth_m}], "
               "fingers: {NAME: {in_contact, manipulability, p_WC_m, p_WF_m (of the fingertip)}}, "
               "gravity_W_m_s2, stand_in (it holds the object before the fingers do)"},
    MethodSpec{"unsubscribe", "call unsubscribe", "end a subscription", kUnsubscribe, false,
               "sub, seq, dropped"},
    MethodSpec{"version", "version", "version of the daemon", {}, false, "version, protocol"},
};

}  // namespace regrasp::rows
