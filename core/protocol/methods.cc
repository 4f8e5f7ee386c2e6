#include "core/protocol/methods.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "core/exploration/criterion.h"
#include "core/exploration/estimator.h"

namespace regrasp {
namespace {

using enum ParamType;

constexpr std::array<std::string_view, 5> kPresets = {"off", "fine", "paper", "coarse", "taxel"};
constexpr std::array<std::string_view, 6> kPlots = {"comparison", "contacts", "gait",
                                                    "incident",   "quality",  "scene"};
constexpr std::array<std::string_view, 6> kTopics = {"contacts", "events", "joints",
                                                     "quality",  "status", "truth"};

// The default first.
constexpr std::array kEstimators = {
    kEstimatorNames[static_cast<std::size_t>(Estimator::kLeastSquares)],
    kEstimatorNames[static_cast<std::size_t>(Estimator::kSecant)]};

constexpr ParamSpec kCheckpointName = {
    .name = "name",
    .type = kString,
    .sentence = "letters, digits, - _ . ; at most 64, neither . nor - first",
    .required = true};
constexpr std::array kCheckpointSave = {kCheckpointName};
constexpr std::array kCheckpointRestore = {
    kCheckpointName,
    ParamSpec{.name = "seed",
              .type = kInteger,
              .sentence = "branch: sensor noise and later random choices follow this seed",
              .min = 0,
              .max = kMaxSafeInteger,
              .default_text = "go on identically"},
    ParamSpec{.name = "reexecute",
              .type = kBool,
              .sentence = "execute the commands again from tick 0, rather than load the state",
              .default_text = "false"},
};
constexpr std::array kDescribe = {
    ParamSpec{.name = "method",
              .type = kString,
              .sentence = "only this method",
              .default_text = "all methods"},
};
constexpr std::array kEvents = {
    ParamSpec{.name = "count",
              .type = kInteger,
              .sentence = "at most so many, the newest",
              .min = 1,
              .max = 1000,
              .default_text = "100"},
};
constexpr std::array kExplore = {
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
              .values = kEstimators,
              .default_text = "least_squares"},
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
constexpr std::array kHello = {
    ParamSpec{.name = "protocol",
              .type = kIntegerPair,
              .sentence = "lowest and highest version the client speaks",
              .required = true,
              .min = 0,
              .max = 1e6},
};
constexpr std::array kJobId = {
    ParamSpec{.name = "id",
              .type = kInteger,
              .sentence = "number of the job",
              .required = true,
              .min = 1,
              .max = kMaxSafeInteger},
};
constexpr std::array kJobWait = {
    ParamSpec{.name = "id",
              .type = kInteger,
              .sentence = "number of the job",
              .required = true,
              .min = 1,
              .max = kMaxSafeInteger},
    ParamSpec{.name = "timeout_s",
              .type = kNumber,
              .sentence = "answer with error -32004 after so long (wall clock)",
              .unit = "s",
              .min = 0,
              .max = 1e6,
              .default_text = "no limit"},
};
constexpr std::array kMove = {
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
constexpr std::array kNoiseSet = {
    ParamSpec{.name = "preset",
              .type = kEnum,
              .sentence = "all levels of a preset; other parameters then change single levels",
              .values = kPresets,
              .default_text = "the present levels"},
    ParamSpec{.name = "position_m",
              .sentence = "contact position, standard deviation per axis",
              .unit = "m",
              .min = 0,
              .max = 0.1,
              .default_text = "unchanged"},
    ParamSpec{.name = "normal_rad",
              .sentence = "contact normal, per tangent axis",
              .unit = "rad",
              .min = 0,
              .max = 1.6,
              .default_text = "unchanged"},
    ParamSpec{.name = "force_n",
              .sentence = "normal force",
              .unit = "N",
              .min = 0,
              .max = 10,
              .default_text = "unchanged"},
    ParamSpec{.name = "joint_rad",
              .sentence = "joint angle",
              .unit = "rad",
              .min = 0,
              .max = 1.6,
              .default_text = "unchanged"},
    ParamSpec{.name = "object_position_m",
              .sentence = "object position, per axis",
              .unit = "m",
              .min = 0,
              .max = 0.1,
              .default_text = "unchanged"},
    ParamSpec{.name = "object_rotation_rad",
              .sentence = "object orientation, per axis",
              .unit = "rad",
              .min = 0,
              .max = 1.6,
              .default_text = "unchanged"},
    ParamSpec{.name = "position_bias_m",
              .sentence = "contact position, constant, per axis of the fingertip",
              .unit = "m",
              .min = 0,
              .max = 0.02,
              .default_text = "unchanged"},
    ParamSpec{.name = "force_bias_n",
              .sentence = "normal force, constant",
              .unit = "N",
              .min = 0,
              .max = 2,
              .default_text = "unchanged"},
    ParamSpec{.name = "joint_bias_rad",
              .sentence = "joint angle, constant",
              .unit = "rad",
              .min = 0,
              .max = 0.5,
              .default_text = "unchanged"},
    ParamSpec{.name = "object_bias_m",
              .sentence = "object position, constant, per axis",
              .unit = "m",
              .min = 0,
              .max = 0.05,
              .default_text = "unchanged"},
    ParamSpec{.name = "position_drift_m",
              .sentence = "contact position, random walk, after one second",
              .unit = "m",
              .min = 0,
              .max = 0.02,
              .default_text = "unchanged"},
    ParamSpec{.name = "force_drift_n",
              .sentence = "normal force, random walk, after one second",
              .unit = "N",
              .min = 0,
              .max = 2,
              .default_text = "unchanged"},
    ParamSpec{.name = "object_drift_m",
              .sentence = "object position, random walk, after one second",
              .unit = "m",
              .min = 0,
              .max = 0.05,
              .default_text = "unchanged"},
    ParamSpec{.name = "dropout_fraction",
              .sentence = "share of the time in which a fingertip feels nothing",
              .min = 0,
              .max = 0.9,
              .default_text = "unchanged"},
    ParamSpec{.name = "dropout_gap_s",
              .sentence = "mean length of such a gap; at least a sample",
              .unit = "s",
              .min = 0,
              .max = 1,
              .default_text = "unchanged"},
    ParamSpec{.name = "latency_s",
              .sentence = "age of what a fingertip reports",
              .unit = "s",
              .min = 0,
              .max = 0.02,
              .default_text = "unchanged"},
};
constexpr std::array kParamGet = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the parameter",
              .names = NameSource::kParameter,
              .default_text = "all parameters"},
};
constexpr std::array kParamList = {
    ParamSpec{.name = "group",
              .type = kEnum,
              .sentence = "only parameters whose names begin so: gait",
              .names = NameSource::kParameterGroup,
              .default_text = "all"},
    ParamSpec{.name = "changed",
              .type = kBool,
              .sentence = "only parameters that differ from their defaults",
              .default_text = "false"},
};
constexpr std::array kParamLoad = {
    ParamSpec{.name = "parameters",
              .type = kObject,
              .sentence = "values by name; all are set, or none where one is refused",
              .required = true},
};
constexpr std::array kParamReset = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the parameter, or the group: gait",
              .names = NameSource::kParameterOrGroup,
              .default_text = "all parameters"},
};
constexpr std::array kParamSet = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the parameter",
              .required = true,
              .names = NameSource::kParameter},
    ParamSpec{.name = "value",
              .type = kParameterValue,
              .sentence = "its new value, of the type and in the range that param.get tells",
              .required = true},
};
constexpr std::array kShape = {
    ParamSpec{.name = "mesh",
              .type = kBool,
              .sentence = "also the surface as a closed mesh, in the object's frame",
              .default_text = "false"},
};

constexpr std::array kPlot = {
    ParamSpec{.name = "name",
              .type = kEnum,
              .sentence = "the picture",
              .required = true,
              .values = kPlots},
    ParamSpec{.name = "file",
              .type = kString,
              .sentence = "file name (not a path), written in the daemon's output directory; its "
                          "suffix decides: .png, .jpg, .pdf, .svg",
              .default_text = "NAME.png, or NAME-2.png ... where that is there"},
    ParamSpec{.name = "overwrite",
              .type = kBool,
              .sentence = "replace a picture of this name; otherwise that is an error",
              .default_text = "false"},
    ParamSpec{.name = "last_s",
              .type = kNumber,
              .sentence = "only the last so many seconds",
              .unit = "s",
              .min = 0.1,
              .max = 600,
              .default_text = "everything kept"},
    ParamSpec{.name = "size_m",
              .type = kNumber,
              .sentence =
                  "printed width; quality, gait and comparison have text of at least 7 pt at any "
                  "width, the others from 165 mm on",
              .unit = "m",
              .min = 0.05,
              .max = 1,
              .default_text = "for a screen"},
    ParamSpec{.name = "title",
              .type = kBool,
              .sentence = "whether the picture has its title and its line of facts",
              .default_text = "true"},
    ParamSpec{.name = "font_size_pt",
              .type = kNumber,
              .sentence = "with size: no text on paper is smaller",
              .unit = "pt",
              .min = 4,
              .max = 24,
              .default_text = "7"},
    ParamSpec{.name = "dpi",
              .type = kNumber,
              .sentence = "with size: pixels per inch of a .png or .jpg",
              .min = 50,
              .max = 1200,
              .default_text = "1600 pixels wide"}};
constexpr std::array kPush = {
    ParamSpec{.name = "force_n",
              .type = kVector3,
              .sentence = "force at the object's centre, in W",
              .required = true,
              .unit = "N",
              .min = -100,
              .max = 100},
    ParamSpec{.name = "duration_s",
              .type = kNumber,
              .sentence = "how long it acts",
              .unit = "s",
              .min = 0.001,
              .max = 60,
              .default_text = "0.1"},
};
constexpr std::array kRecordStart = {
    ParamSpec{.name = "file",
              .type = kString,
              .sentence = "file name (not a path), written in the daemon's output directory",
              .default_text = "run-001.mcap, or the next number"},
    ParamSpec{.name = "rate_hz",
              .sentence = "samples per second of simulated time; commands, events and state hashes "
                          "are always complete",
              .unit = "Hz",
              .min = 0.1,
              .max = 100,
              .default_text = "25"},
};
constexpr std::array kReset = {
    ParamSpec{.name = "seed",
              .type = kInteger,
              .sentence = "seed of the new run",
              .min = 0,
              .max = kMaxSafeInteger,
              .default_text = "the present seed"},
    ParamSpec{.name = "object",
              .type = kEnum,
              .sentence = "another object, by name",
              .names = NameSource::kObject,
              .default_text = "the present object"},
};
constexpr std::array kRotate = {
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
constexpr std::array kStep = {
    ParamSpec{.name = "ticks",
              .type = kInteger,
              .sentence = "how many ticks",
              .min = 1,
              .max = 1e9,
              .default_text = "1"},
    ParamSpec{.name = "until_job_ends",
              .type = kBool,
              .sentence = "no further than to the end of the job that is running or waits to begin",
              .default_text = "false"},
};
constexpr std::array kSubscribe = {
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
constexpr std::array kUnsubscribe = {
    ParamSpec{.name = "sub",
              .type = kInteger,
              .sentence = "number of the subscription",
              .required = true,
              .min = 1,
              .max = kMaxSafeInteger},
};

constexpr std::span<const ParamSpec> kNone = {};

constexpr std::array kMethods = {
    MethodSpec{"checkpoint.list", "checkpoint list", "the checkpoints in the output directory",
               kNone, false,
               "checkpoints: [{name, tick, time_s, state, state_hash, seed, object, commands, "
               "same_build}]"},
    MethodSpec{"checkpoint.restore", "checkpoint restore",
               "go on from a checkpoint: identically, or with another seed", kCheckpointRestore,
               true,
               "job; continues: the job that goes on after it, or null; from: state or commands; "
               "tick, state_hash; differences: the build that saved it, where that is another, and "
               "parameters that are not the defaults, a sentence each"},
    MethodSpec{"checkpoint.save", "checkpoint save", "keep this moment, to go on from it later",
               kCheckpointSave, false, "name, tick, time_s, state, state_hash, commands, path"},
    MethodSpec{
        "contacts", "contacts", "what the controller senses at each fingertip", kNone, false,
        "tick, time_s, object: {p_WO_m, q_WO_wxyz, p_WO_reference_m (where control wants it)}, "
        "normals: outward (out of the object), friction, weight_n, max_force_n (what the "
        "controller reckons with), fingers: {NAME: {role, in_contact, p_WC_m, normal_W, force_n, "
        "force_command_W_n}}; p_WC_m and normal_W are null without contact; evaluate takes this "
        "answer as it is"},
    MethodSpec{"describe", "call describe",
               "every method with its parameters, types, units and ranges", kDescribe, false,
               "version, protocol, methods, errors"},
    MethodSpec{"events", "events", "the latest events", kEvents, false,
               "events: [{tick, t_s, kind, finger, text, ...}], oldest first; dropped"},
    MethodSpec{"explore", "explore", "improve the grasp by sliding one finger over the surface",
               kExplore, true, "job"},
    MethodSpec{"grasp", "grasp", "close the hand on the object and hold it", kNone, true, "job"},
    MethodSpec{"hello", "call hello", "agree on a protocol version (optional)", kHello, false,
               "protocol, version, server"},
    MethodSpec{"identity", "call identity",
               "what decides the results, besides seed and commands: equal answers, equal bits",
               kNone, false,
               "build; stepper; models: {scenario, hand, object}, each {name, hash of the model as "
               "it was read}; parameters: {NAME: value} of those that differ from their defaults"},
    MethodSpec{"job.cancel", "job cancel", "end a job", kJobId, false, "the record of the job"},
    MethodSpec{"job.get", "job show", "the record of a job", kJobId, false,
               "the record of the job"},
    MethodSpec{"job.list", "job list", "the last 256 jobs, oldest first", kNone, false,
               "jobs: [record]"},
    MethodSpec{"job.wait", "job wait", "wait until a job has ended; the only deferred answer",
               kJobWait, false, "the record of the job"},
    MethodSpec{
        "joints", "joints", "joint angles, torques and limits", kNone, false,
        "tick, time_s, joints: [{name, finger, angle_rad, torque_nm, lower_rad, upper_rad}]"},
    MethodSpec{"move", "move", "move the object a little with all fingers, without a regrasp",
               kMove, true, "job"},
    MethodSpec{"noise.get", "noise show", "noise levels of the sensors", kNone, false,
               "preset and every level"},
    MethodSpec{"noise.set", "noise set", "change noise levels", kNoiseSet, false,
               "preset and every level"},
    MethodSpec{"param.get", "param get", "values, units, ranges and sources of parameters",
               kParamGet, false,
               "name, value, default, changed, type, unit, min, max, words, size, description, "
               "source (of the value), default_source; without a name parameters: [...]"},
    MethodSpec{"param.list", "param list", "every parameter, a group, or what has been changed",
               kParamList, false, "parameters: [{name, value, ... as param.get}]"},
    MethodSpec{"param.load", "param load", "set many parameters at once", kParamLoad, false,
               "parameters: [{name, value, ... as param.get}] that were given; kept: {NAME: value} "
               "of the others that differ from their defaults"},
    MethodSpec{"param.reset", "param reset", "set parameters back to their defaults", kParamReset,
               false, "parameters: [{name, value, before, ...}] that were changed before"},
    MethodSpec{"param.set", "param set", "change a parameter", kParamSet, false,
               "name, value, default, changed, type, unit, min, max, words, size, description, "
               "source, default_source"},
    MethodSpec{"pause", "pause", "stop the clock of the simulation", kNone, false, "paused, tick"},
    MethodSpec{"plot", "plot", "draw a picture into the output directory", kPlot, false,
               "file (name), path, bytes, tick"},
    MethodSpec{"push", "push", "push the object: a disturbance", kPush, false,
               "force_n, duration_s"},
    MethodSpec{
        "quality", "quality", "quality of the grasp", kNone, false,
        "tick, time_s, criterion, stability, stability_measure, threshold, load_margin_n, "
        "measures: [NAME] and the value of each by its name, torque_scale_m "
        "(mean distance of the contacts from the object's centre; torques are divided by "
        "it), fingers: {NAME: {manipulability, load_margin_without_n, joint_limit_margin_rad}}"},
    MethodSpec{"record.list", "record list", "the run files in the output directory", kNone, false,
               "recordings: [{file, bytes, complete, recording}]"},
    MethodSpec{"record.start", "record start",
               "write the run into a file, from its beginning; it can be replayed", kRecordStart,
               false, "file, path, rate_hz, tick, commands (so far)"},
    MethodSpec{"record.stop", "record stop", "end the run file", kNone, false,
               "file, path, messages, bytes, dropped"},
    MethodSpec{"release", "release", "open the hand", kNone, true, "job"},
    MethodSpec{"reset", "reset", "start a new run; parameters and noise levels stay", kReset, false,
               "seed, object, changed_parameters: {NAME: value} that stay, warnings [] (why "
               "this object cannot be grasped where it begins)"},
    MethodSpec{"resume", "resume", "let the clock of the simulation run again", kNone, false,
               "paused, tick"},
    MethodSpec{
        "rotate", "rotate", "turn the object in the hand by finger gaiting", kRotate, true,
        "job; its record when it has ended: angle_rad (signed, unwrapped, true), turns, "
        "gait_cycles, regrasps, dropped, max_position_error_m (of the object's centre from where "
        "it began), max_tilt_rad (of the axis), max_lag_m (behind its reference), "
        "reference_resets (times the reference followed the object), sim_time_s"},
    MethodSpec{"shape", "shape", "the object's surface as the fingers have felt it", kShape, false,
               "tick, time_s, object, touched_fraction (of all directions), touched_cells, cells, "
               "mean_radius_m, truth (for judging; null before anything was felt well: cells, "
               "rms_error_m, mean_error_m (bias, positive outside), normal_error_rad (median)), "
               "mesh: {vertices_O_m, normals_O, unknown_rad (angle to the nearest felt "
               "direction), error_m (to the true surface), triangles}"},
    MethodSpec{
        "shutdown", "down", "stop the daemon cleanly", kNone, false,
        "stopping, activated (true: the service manager starts another at the next connection)"},
    MethodSpec{"status", "status", "state of daemon and simulation", kNone, false,
               "version, protocol, state, paused, clock (continuous, lockstep), "
               "advancing (time goes on now), tick, time_s, state_hash, real_time_factor, "
               "speed, stepper, tick_p99_s, seed, hand, object, warnings, job, gait: {active, "
               "phase, finger, state, "
               "reference_angle_rad, target_angle_rad, achieved_angle_rad, cycles, regrasps}, "
               "incident (the last drop: "
               "tick, cause, record, "
               "picture; or null), noise, clients, ..."},
    MethodSpec{"step", "step", "advance a simulation that is paused, or stands still in lockstep",
               kStep, true, "job"},
    MethodSpec{"stop", "stop", "end the current job and keep holding", kNone, false,
               "job (the one that ends), or null"},
    MethodSpec{"subscribe", "watch", "receive a topic as notifications", kSubscribe, false, "sub"},
    MethodSpec{"truth", "truth", "what only the simulator knows", kNone, false,
               "tick, time_s, object {p_WO_m, q_WO_wxyz, v_m_s, w_rad_s, mass_kg, friction}, "
               "contacts [{link, finger, p_WC_m, normal_W, force_W_n, depth_m}], gravity_W_m_s2"},
    MethodSpec{"unsubscribe", "call unsubscribe", "end a subscription", kUnsubscribe, false,
               "sub, seq, dropped"},
    MethodSpec{"version", "version", "version of the daemon", kNone, false, "version, protocol"},
};

static_assert(std::ranges::is_sorted(kMethods, {}, &MethodSpec::name));
static_assert(std::ranges::is_sorted(kTopics));

}  // namespace

std::string_view Name(ParamType type) {
  switch (type) {
    case kInteger:
      return "integer";
    case kNumber:
      return "number";
    case kBool:
      return "boolean";
    case kString:
      return "string";
    case kEnum:
      return "name";
    case kVector3:
      return "number[3]";
    case kParameterValue:
      return "number, number[3], boolean or word";
    case kObject:
      return "object";
    case kIntegerPair:
      return "integer[2]";
  }
  return "";
}

std::string_view Name(NameSource source) {
  switch (source) {
    case NameSource::kNone:
      return "";
    case NameSource::kFinger:
      return "finger";
    case NameSource::kObject:
      return "object";
    case NameSource::kParameter:
      return "parameter";
    case NameSource::kParameterGroup:
      return "parameter group";
    case NameSource::kParameterOrGroup:
      return "parameter or group";
  }
  return "";
}

std::span<const MethodSpec> MethodTable() { return kMethods; }

const MethodSpec* FindMethod(std::string_view name) {
  const auto it = std::ranges::lower_bound(kMethods, name, {}, &MethodSpec::name);
  return it != kMethods.end() && it->name == name ? &*it : nullptr;
}

const ParamSpec* FindParam(const MethodSpec& method, std::string_view name) {
  for (const ParamSpec& param : method.params)
    if (param.name == name) return &param;
  return nullptr;
}

std::span<const std::string_view> TopicNames() { return kTopics; }

}  // namespace regrasp
