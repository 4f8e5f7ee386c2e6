// Control: what changes the run.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "cli/client/context.h"
#include "cli/commands/jobs.h"
#include "cli/commands/parameters.h"
#include "cli/grammar/units.h"
#include "core/protocol/methods.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr const char* kGroup = "Control";

ExitCode Rotate(Context& context, const Invocation& invocation) {
  const Json& p = invocation.params;
  const auto given = p.contains("angle_rad") + p.contains("turns") + p.contains("continuous");
  if (given != 1) {
    throw CliError(
        kUsage, fmt::format("rotate takes one of --angle, --turns and --continuous, not {}", given),
        "regrasp rotate --angle 90 --wait");
  }
  if (p.contains("continuous") && invocation.Has("wait")) {
    throw CliError(kUsage, "rotate --continuous never ends by itself: --wait makes no sense",
                   "regrasp rotate --continuous, then regrasp stop");
  }
  return StartJob(context, invocation);
}

ExitCode Move(Context& context, const Invocation& invocation) {
  if (invocation.params.empty()) {
    throw CliError(kUsage, "move takes --by (mm), --turn (degrees) or both, not none",
                   "regrasp move --by 0,0,5 --wait");
  }
  const auto check = [&](const char* key, const char* flag, double scale, double most,
                         const char* unit) {
    if (!invocation.params.contains(key)) return;
    double squares = 0;
    for (const Json& part : invocation.params[key])
      squares += part.get<double>() * part.get<double>();
    const double length = scale * std::sqrt(squares);
    if (length > most * (1 + 1e-9))
      throw CliError(kUsage, fmt::format("{0} is {1:.4g} {2} long; allowed are at most {3:g} {2}",
                                         flag, length, unit, most));
  };
  check("offset_m", "--by", 1e3, 1e3 * kMaxMoveOffset, "mm");
  check("rotation_rad", "--turn", kDegrees, 180, "degrees");
  return StartJob(context, invocation);
}

ExitCode Stop(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    const Json &job = At(answer, "job"), &step = At(answer, "step");
    if (!job.is_null() && At(answer, "begun") == false)
      context.out().Line(fmt::format("job {} cancelled before it began", Plain(job)));
    else if (!job.is_null())
      context.out().Line(fmt::format("job {} stopped; the hand keeps holding", Plain(job)));
    if (!step.is_null()) context.out().Line(fmt::format("job {} stopped: step", Plain(step)));
    if (job.is_null() && step.is_null()) context.out().Line("nothing to stop");
  });
  return kOk;
}

ExitCode PauseOrResume(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    const bool paused = At(answer, "paused") == true;
    const bool stands = !paused && At(answer, "clock") == "lockstep";
    context.out().Line(fmt::format("{} at tick {}{}",
                                   paused   ? "paused"
                                   : stands ? "no longer paused"
                                            : "running",
                                   Plain(At(answer, "tick")),
                                   stands ? "; in lockstep time goes on while a job runs" : ""));
  });
  return kOk;
}

ExitCode Reset(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    context.out().Line(fmt::format("new run: object {}, seed {}", Plain(At(answer, "object")),
                                   Plain(At(answer, "seed"))));
    for (const Json& warning : At(answer, "warnings"))
      context.out().Line("warning: " + Plain(warning));
    const std::string changed = ChangedText(At(answer, "changed_parameters"));
    if (!changed.empty())
      context.out().Line(fmt::format("changed parameters stay: {}{}", changed,
                                     context.Next("regrasp param reset")));
  });
  return kOk;
}

void PrintNoise(Output& out, const Json& noise) {
  const auto line = [&](const char* what, const char* key, int digits, double scale,
                        const char* unit) {
    out.Line(fmt::format("  {:<18}{:>8} {}", what, Fixed(At(noise, key), digits, scale), unit));
  };
  out.Line(fmt::format("noise preset {}", out.Paint(Plain(At(noise, "preset")), Style::kBold)));
  line("contact position", "position_m", 2, 1e3, "mm");
  line("contact normal", "normal_rad", 2, kDegrees, "deg");
  line("normal force", "force_n", 3, 1, "N");
  line("joint angle", "joint_rad", 2, kDegrees, "deg");
  line("object position", "object_position_m", 2, 1e3, "mm");
  line("object orientation", "object_rotation_rad", 2, kDegrees, "deg");
  // What the presets do not have is shown where it is set.
  const auto more = [&](const char* what, const char* key, int digits, double scale,
                        const char* unit) {
    if (At(noise, key).is_number() && At(noise, key) != 0.0) line(what, key, digits, scale, unit);
  };
  more("taxels apart", "taxel_pitch_m", 2, 1e3, "mm");
  more("pose rate", "object_rate_hz", 0, 1, "Hz");
  more("pose delay", "object_delay_frames", 0, 1, "poses");
  more("position bias", "position_bias_m", 2, 1e3, "mm");
  more("force bias", "force_bias_n", 3, 1, "N");
  more("joint bias", "joint_bias_rad", 2, kDegrees, "deg");
  more("object bias", "object_bias_m", 2, 1e3, "mm");
  more("position drift", "position_drift_m", 2, 1e3, "mm after 1 s");
  more("force drift", "force_drift_n", 3, 1, "N after 1 s");
  more("object drift", "object_drift_m", 2, 1e3, "mm after 1 s");
  more("lost readings", "dropout_fraction", 1, 100, "%");
  more("length of a gap", "dropout_gap_s", 3, 1, "s");
  more("latency", "latency_s", 1, 1e3, "ms");
}

ExitCode SendNoise(Context& context, const char* method, const Json& params) {
  const Json answer = context.client().Call(method, params);
  context.Print(answer, [&] { PrintNoise(context.out(), answer); });
  return kOk;
}

ExitCode NoiseShow(Context& context, const Invocation&) {
  return SendNoise(context, "noise.get", Json::object());
}
ExitCode NoisePreset(Context& context, const Invocation& invocation) {
  return SendNoise(context, "noise.set", invocation.params);
}
ExitCode NoiseOff(Context& context, const Invocation&) {
  return SendNoise(context, "noise.set", {{"preset", "off"}});
}

ExitCode NoiseSet(Context& context, const Invocation& invocation) {
  Json params = invocation.params;
  if (invocation.Has("pose")) {
    const std::string pose = invocation.Text("pose");
    const auto comma = pose.find(',');
    if (comma == std::string::npos)
      throw CliError(kUsage, fmt::format("--pose '{}' is not MM,DEG", pose),
                     "regrasp noise set --pose 1,2");
    params["object_position_m"] = ParseQuantity(pose.substr(0, comma), "--pose", "mm") * 1e-3;
    params["object_rotation_rad"] =
        ParseQuantity(pose.substr(comma + 1), "--pose", "deg") / kDegrees;
  }
  if (params.empty())
    throw CliError(kUsage, "noise set: no level given",
                   "regrasp noise set --position 1 --normal 2");
  return SendNoise(context, "noise.set", params);
}

ExitCode Push(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    context.out().Line(fmt::format("pushing with {} N for {} s", Vector(At(answer, "force_n"), 2),
                                   Plain(At(answer, "duration_s"))));
  });
  return kOk;
}

/// A job starts as its row says, but for what is said here.
CommandSpec JobCommand(const MethodSpec& method) {
  if (method.name == "rotate") return MethodCommand(method.name, kGroup, Rotate);
  if (method.name == "explore")
    return MethodCommand(method.name, kGroup, StartJob, {.positional = {"finger"}});
  if (method.name != "move") return MethodCommand(method.name, kGroup, StartJob);
  CommandSpec move = MethodCommand(method.name, kGroup, Move);
  move.args[0].flags = "--by";
  move.args[0].help = "shift of the object's centre along the axes of W, in mm, at most 50 long";
  move.args[1].flags = "--turn";
  move.args[1].help = "turn, a rotation vector in W, in degrees, at most 180 long";
  return move;
}

}  // namespace

std::vector<CommandSpec> ControlCommands() {
  std::vector<std::string_view> levels;
  for (const ParamSpec& param : FindMethod("noise.set")->params)
    if (param.name != "preset") levels.push_back(param.name);
  CommandSpec preset =
      MethodCommand("noise.set", kGroup, NoisePreset, {.positional = {"preset"}, .hidden = levels});
  preset.words = "noise preset";
  preset.sentence = "set all noise levels to a preset";
  preset.args.front().required = true;
  CommandSpec noise_off{"noise off", kGroup, "switch all noise off", nullptr, {}, NoiseOff};
  std::vector<CommandSpec> commands;
  for (const MethodSpec& method : JobMethods()) commands.push_back(JobCommand(method));
  for (CommandSpec& command : std::vector<CommandSpec>{
           MethodCommand("stop", kGroup, Stop),
           MethodCommand("pause", kGroup, PauseOrResume),
           MethodCommand("resume", kGroup, PauseOrResume),
           MethodCommand("step", kGroup, StartJob, {.positional = {"ticks"}}),
           MethodCommand("reset", kGroup, Reset),
           MethodCommand("noise.get", kGroup, NoiseShow),
           MethodCommand("noise.set", kGroup, NoiseSet,
                         {.hidden = {"preset", "object_position_m", "object_rotation_rad"},
                         .extra = {{.key = "pose",
                                  .flags = "--pose",
                                  .metavar = "MM,DEG",
                                  .help = "object position and orientation, per axis",
                                  .default_text = "unchanged"}}}),
           preset,
           noise_off,
           MethodCommand("push", kGroup, Push),
       })
    commands.push_back(std::move(command));
  for (CommandSpec& command : ParameterCommands()) commands.push_back(std::move(command));
  return commands;
}

}  // namespace regrasp::cli
