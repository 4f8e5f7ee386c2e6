// Inspect: what changes nothing.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "cli/client/context.h"
#include "cli/commands/jobs.h"
#include "cli/commands/parameters.h"
#include "cli/commands/surface_file.h"
#include "cli/help/wrap.h"
#include "cli/top/top.h"
#include "core/files/draft.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr const char* kGroup = "Inspect";

Style StateStyle(const std::string& state) {
  if (state == "dropped" || state == "faulted") return Style::kBad;
  return state == "idle" ? Style::kPlain : Style::kGood;
}

std::string JobSummary(const Json& job) {
  if (job.is_object()) {
    std::string text = fmt::format("{} {}", Plain(At(job, "id")), Plain(At(job, "method")));
    if (At(job, "finger").is_string()) text += " " + Plain(At(job, "finger"));
    text += ", " + Plain(At(job, "state"));
    if (At(job, "state") == "running")
      text += fmt::format(" {} %", Fixed(At(job, "progress"), 0, 100));
    return text;
  }
  return job.is_null() ? "none" : Plain(job);
}

ExitCode Status(Context& context, const Invocation& invocation) {
  const Json s = context.Call(invocation);
  context.Print(s, [&] {
    Output& out = context.out();
    const auto line = [&out](const char* name, const std::string& value) {
      out.Line(fmt::format("{:<12}{}", name, value));
    };
    const std::string state = Plain(At(s, "state"));
    line("state", out.Paint(state, StateStyle(state)) +
                      (At(s, "paused") == true ? out.Paint(" (paused)", Style::kWarn) : ""));
    const bool lockstep = At(s, "clock") == "lockstep";
    const bool stands = At(s, "paused") == true || state == "faulted";  // no job makes it go on
    std::string time =
        fmt::format("{} s (tick {})", Fixed(At(s, "time_s"), 3), Plain(At(s, "tick")));
    // 0 where time stands still: the state, or the next words, say why.
    if (const Json& factor = At(s, "real_time_factor"); factor.is_number() && factor != 0.0)
      time += fmt::format(", {} x real time", Fixed(factor, 2));
    if (lockstep && At(s, "advancing") == true)
      time += ", lockstep: until the job ends";
    else if (lockstep)
      time += stands ? ", lockstep" : ", lockstep: waits for a job";
    line("time", time);
    line("run", fmt::format("hand {}, object {}, seed {}", Plain(At(s, "hand")),
                            Plain(At(s, "object")), Plain(At(s, "seed"))));
    const Json& noise = At(s, "noise");
    std::string stepper = Plain(At(s, "stepper"));
    if (const Json& reason = At(s, "stepper_reason"); reason.is_string())  // not of an older daemon
      stepper += fmt::format(" ({})", Plain(reason));
    out.Add(Wrap(fmt::format("{:<12}{}", "stepper", stepper), 12));
    line("noise", Plain(noise.is_object() ? At(noise, "preset") : noise));
    line("job", JobSummary(At(s, "job")));
    const std::string changed = ChangedText(At(s, "changed_parameters"));
    if (!changed.empty()) line("changed", changed + "    (regrasp param list --changed)");
    if (At(s, "recording").is_string())
      line("recording", Plain(At(s, "recording")) + "    (regrasp record stop)");
    const Json& incident = At(s, "incident");
    if (incident.is_object() && (state == "dropped" || state == "faulted"))
      line("incident", Plain(At(incident, "record")) + "    (regrasp plot incident)");
    line("daemon", fmt::format("regraspd {} on {}, {} client{}", Plain(At(s, "version")),
                               context.client().path(), Plain(At(s, "clients")),
                               At(s, "clients") == 1 ? "" : "s"));
    if (context.options().verbose) {
      line("hash", Plain(At(s, "state_hash")));
      for (const char* key : {"speed", "output_dir", "pid", "uptime_s", "socket"}) {
        if (!At(s, key).is_null()) line(key, Plain(At(s, key)));
      }
    }
  });
  return kOk;
}

/// One row per finger: the finger's name, then its fields.
std::vector<Json> FingerRows(const Json& answer) {
  std::vector<Json> rows;
  for (const auto& [name, fields] : Named(At(answer, "fingers"), "finger")) {
    Json row = {{"tick", At(answer, "tick")}, {"time_s", At(answer, "time_s")}, {"finger", name}};
    row.update(fields);
    rows.push_back(row);
  }
  return rows;
}

void PrintContacts(Output& out, const Json& answer) {
  Table table({"FINGER", "ROLE", ">POSITION [mm]", ">NORMAL", ">FORCE [N]", "0 to 2"});
  for (const auto& [name, f] : Named(At(answer, "fingers"), "finger")) {
    const bool touches = At(f, "in_contact") == true;
    const Json& force = At(f, "force_n");
    table.Row({name, Plain(At(f, "role")), touches ? Vector(At(f, "p_WC_m"), 1, 1e3) : "no contact",
               touches ? Vector(At(f, "normal_W"), 2) : "", Fixed(force, 2),
               out.Bar(force.is_number() ? force.get<double>() / 2 : 0, 6)});
  }
  out.Add(table.Text(out));
}

ExitCode Contacts(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.PrintRows(answer, FingerRows(answer), [&] { PrintContacts(context.out(), answer); });
  return kOk;
}

ExitCode Joints(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  const Json& joints = At(answer, "joints");
  context.PrintRows(answer, {joints.begin(), joints.end()}, [&] {
    Output& out = context.out();
    Table table({"JOINT", "FINGER", ">ANGLE [deg]", ">LOWER", "RANGE", ">UPPER", ">TORQUE [N m]"});
    for (const auto& j : joints) {
      double fraction = 0;
      if (At(j, "lower_rad").is_number() && At(j, "upper_rad").is_number() &&
          At(j, "angle_rad").is_number()) {
        const double lower = At(j, "lower_rad"), upper = At(j, "upper_rad"),
                     angle = At(j, "angle_rad");
        fraction = upper > lower ? (angle - lower) / (upper - lower) : 0;
      }
      table.Row({Plain(At(j, "name")), At(j, "finger").is_null() ? "" : Plain(At(j, "finger")),
                 Fixed(At(j, "angle_rad"), 1, kDegrees), Fixed(At(j, "lower_rad"), 0, kDegrees),
                 out.Bar(fraction, 12), Fixed(At(j, "upper_rad"), 0, kDegrees),
                 Fixed(At(j, "torque_nm"), 3)});
    }
    out.Add(table.Text(out));
  });
  return kOk;
}

void PrintQuality(Output& out, const Json& q) {
  const Json& stability = At(q, "stability");
  const Json& threshold = At(q, "threshold");
  const bool low = stability.is_number() && threshold.is_number() &&
                   stability.get<double>() < threshold.get<double>();
  out.Line(fmt::format("{:<22}{}  (threshold {})", "stability",
                       out.Paint(Fixed(stability, 4), low ? Style::kWarn : Style::kGood),
                       Fixed(threshold, 4)));
  out.Line(fmt::format("{:<22}{}", "active criterion", Plain(At(q, "criterion"))));
  out.Line(fmt::format("load margin {}{}{} N", out.Rho(),
                       std::string(static_cast<std::size_t>(10 - DisplayWidth(out.Rho())), ' '),
                       Fixed(At(q, "load_margin_n"), 3)));
  for (const Json& name : At(q, "measures")) {
    const Json& value = At(q, Plain(name).c_str());
    if (value.is_number()) out.Line(fmt::format("{:<22}{:.4g}", Plain(name), value.get<double>()));
  }
  out.Line();
  const auto fingers = Named(At(q, "fingers"), "finger");
  double largest = 1e-9;
  for (const auto& [name, f] : fingers) {
    if (At(f, "manipulability").is_number())
      largest = std::max(largest, At(f, "manipulability").get<double>());
  }
  Table table({"FINGER", fmt::format(">MANIPULABILITY {}", out.Phi()), "",
               fmt::format(">{} WITHOUT IT [N]", out.Rho()), ">JOINT MARGIN [deg]"});
  for (const auto& [name, f] : fingers) {
    const Json& phi = At(f, "manipulability");
    table.Row({name, Fixed(phi, 3), out.Bar(phi.is_number() ? phi.get<double>() / largest : 0, 14),
               Fixed(At(f, "load_margin_without_n"), 3),
               Fixed(At(f, "joint_limit_margin_rad"), 1, kDegrees)});
  }
  out.Add(table.Text(out));
}

ExitCode Quality(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] { PrintQuality(context.out(), answer); });
  return kOk;
}

ExitCode Truth(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    Output& out = context.out();
    const Json& o = At(answer, "object");
    out.Line(fmt::format("position     {} mm", Vector(At(o, "p_WO_m"), 2, 1e3)));
    out.Line(fmt::format("orientation  {} (w, x, y, z)", Vector(At(o, "q_WO_wxyz"), 4)));
    out.Line(fmt::format("velocity     {} mm/s", Vector(At(o, "v_m_s"), 2, 1e3)));
    out.Line(fmt::format("rotation     {} deg/s", Vector(At(o, "w_rad_s"), 2, kDegrees)));
    out.Line(fmt::format("mass         {} g", Fixed(At(o, "mass_kg"), 1, 1e3)));
    out.Line(fmt::format("gravity      {} m/s2", Vector(At(answer, "gravity_W_m_s2"), 2)));
    out.Line();
    std::vector<std::string> titles = {"LINK", "FINGER", ">POSITION [mm]", ">FORCE ON OBJECT [N]",
                                       ">DEPTH [um]"};
    if (context.options().verbose) titles.push_back(">NORMAL");
    Table table(titles);
    for (const auto& c : At(answer, "contacts")) {
      const auto name = [&c](const char* key) {
        return At(c, key).is_null() ? std::string() : Plain(At(c, key));
      };
      table.Row({name("link"), name("finger"), Vector(At(c, "p_WC_m"), 1, 1e3),
                 Vector(At(c, "force_W_n"), 2), Fixed(At(c, "depth_m"), 0, 1e6),
                 Vector(At(c, "normal_W"), 2)});
    }
    if (At(answer, "contacts").empty()) {
      out.Line("nothing touches the object");
    } else {
      out.Add(table.Text(out));
    }
  });
  return kOk;
}

void PrintShape(Output& out, const Json& s) {
  out.Line(fmt::format("object       {}", Plain(At(s, "object"))));
  out.Line(fmt::format("touched      {} % of all directions ({} of {} cells)",
                       Fixed(At(s, "touched_fraction"), 1, 100), Plain(At(s, "touched_cells")),
                       Plain(At(s, "cells"))));
  out.Line(fmt::format("mean radius  {} mm", Fixed(At(s, "mean_radius_m"), 2, 1e3)));
  const Json& truth = At(s, "truth");
  if (truth.is_null()) return out.Line("error        nothing was felt long enough to judge it");
  out.Line(fmt::format("error        rms {} mm, bias {} mm, normals {}{} (median), by the truth",
                       Fixed(At(truth, "rms_error_m"), 2, 1e3),
                       Fixed(At(truth, "mean_error_m"), 2, 1e3),
                       Fixed(At(truth, "normal_error_rad"), 1, kDegrees), out.Degree()));
}

ExitCode Shape(Context& context, const Invocation& invocation) {
  namespace fs = std::filesystem;
  const std::string target = invocation.Text("output");
  const std::string suffix = fs::path(target).extension().string();
  if (invocation.Has("output") && suffix != ".ply" && suffix != ".stl")
    throw CliError(kUsage, fmt::format("-o {}: the suffix decides: .ply or .stl", target),
                   "regrasp shape -o felt.ply");
  Invocation request = invocation;
  if (invocation.Has("output")) request.params["mesh"] = true;
  Json answer = context.Call(request);
  if (invocation.Has("output")) {
    const Json& mesh = At(answer, "mesh");
    try {
      WriteWhole(target, suffix == ".ply" ? PlyText(mesh) : StlText(mesh),
                 Draft::Existing::kReplace);
    } catch (const std::exception& e) {
      throw CliError(kIo, fmt::format("cannot write {}: {}", target, e.what()),
                     "regrasp shape -o OTHER_FILE");
    }
    answer.erase("mesh");
    answer["path"] = fs::absolute(target).string();
  }
  context.Print(answer, [&] {
    PrintShape(context.out(), answer);
    if (invocation.Has("output")) context.out().Line(fmt::format("written      {}", target));
  });
  return kOk;
}

ExitCode JobList(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  const Json& jobs = At(answer, "jobs");
  context.PrintRows(answer, {jobs.begin(), jobs.end()}, [&] {
    Output& out = context.out();
    if (jobs.empty()) return out.Line("no jobs yet");
    Table table({">ID", "METHOD", "STATE", ">PROGRESS", ">START TICK", ">END TICK", "RESULT"});
    for (const auto& job : jobs) {
      std::string result = At(job, "error").is_string() ? Plain(At(job, "error")) : "";
      if (At(job, "reason").is_string()) result = Plain(At(job, "reason"));
      if (At(job, "end").is_string()) result = Plain(At(job, "end"));
      if (At(job, "angle_rad").is_number())
        result = Fixed(At(job, "angle_rad"), 1, kDegrees) + std::string(out.Degree());
      const auto tick = [&](const char* key) {
        return At(job, key).is_number() ? Plain(At(job, key)) : std::string(out.Dash());
      };
      const bool finger = At(job, "finger").is_string();
      table.Row({Plain(At(job, "id")),
                 Plain(At(job, "method")) + (finger ? " " + Plain(At(job, "finger")) : ""),
                 Plain(At(job, "state")), Fixed(At(job, "progress"), 0, 100) + " %",
                 tick("start_tick"), tick("end_tick"), result});
    }
    out.Add(table.Text(out));
  });
  return kOk;
}

ExitCode JobShow(Context& context, const Invocation& invocation) {
  const Json record = context.Call(invocation);
  context.Print(record, [&] { PrintJob(context.out(), record); });
  return kOk;
}

ExitCode JobWait(Context& context, const Invocation& invocation) {
  const Json record = WaitForJob(context, invocation.params.at("id"));
  context.Print(record, [&] { PrintJob(context.out(), record); });
  return JobExit(record);
}

std::string EventLine(Output& out, const Json& event) {
  std::string text =
      fmt::format("{:>10} s  {:<14}", Fixed(At(event, "t_s"), 3), Plain(At(event, "kind")));
  if (At(event, "text").is_string()) text += " " + Plain(At(event, "text"));
  const std::string kind = Plain(At(event, "kind"));
  const bool bad = kind == "dropped" || kind == "fault";
  return bad ? out.Paint(text, Style::kBad) : text;
}

/// One sample of a topic as one line.
std::string SampleLine(Output& out, const std::string& topic, const Json& sample) {
  if (topic == "events") return EventLine(out, sample);
  const Json& time = At(sample, "time_s").is_null() ? At(sample, "t_s") : At(sample, "time_s");
  std::string text = fmt::format("{:>10} s", Fixed(time, 3));
  if (topic == "status") {
    text += fmt::format("  {:<10} {:>7} x  job {}", Plain(At(sample, "state")),
                        Fixed(At(sample, "real_time_factor"), 2), JobSummary(At(sample, "job")));
  } else if (topic == "quality") {
    text += fmt::format("  stability {}  {} {} N  {}", Fixed(At(sample, "stability"), 3), out.Rho(),
                        Fixed(At(sample, "load_margin_n"), 3), out.Phi());
    for (const auto& [name, f] : Named(At(sample, "fingers"), "finger"))
      text += fmt::format(" {:.2}={}", name, Fixed(At(f, "manipulability"), 2));
  } else if (topic == "contacts") {
    for (const auto& [name, f] : Named(At(sample, "fingers"), "finger")) {
      text += fmt::format("  {} {}", name,
                          At(f, "in_contact") == true ? Fixed(At(f, "force_n"), 2) + " N"
                                                      : std::string(out.Dash()));
    }
  } else if (topic == "joints") {
    for (const auto& j : At(sample, "joints")) text += " " + Fixed(At(j, "angle_rad"), 0, kDegrees);
    text += " deg";
  } else {
    const Json& object = At(sample, "object");
    text += fmt::format("  object {} mm  |{} contacts", Vector(At(object, "p_WO_m"), 2, 1e3),
                        At(sample, "contacts").size());
  }
  return text;
}

ExitCode Stream(Context& context, const std::string& topic, const Json& params,
                std::int64_t count) {
  const Interruptible interruptible;
  context.client().Call("subscribe", params);
  // With --timeout a stream that falls silent is an error; without, it may be silent for ever.
  const double patience = context.options().timeout_s.value_or(0);
  try {
    for (std::int64_t n = 0; count <= 0 || n < count; ++n) {
      const auto sample = context.client().NextEvent(patience);
      if (!sample)
        throw CliError(kTimeout, fmt::format("nothing on '{}' for {:g} s", topic, patience),
                       "regrasp status");
      context.Print(*sample,
                    [&] { context.out().Line(SampleLine(context.out(), topic, *sample)); });
      context.out().Flush();
    }
  } catch (const CliError& error) {
    if (error.code != kInterrupted) throw;
    return kInterrupted;
  }
  return kOk;
}

std::int64_t Count(const Invocation& invocation) {
  if (!invocation.Has("count")) return 0;
  const double count = ParseNumber(invocation.Text("count"), "--count");
  if (count < 1 || count > 1e12 || count != static_cast<double>(static_cast<std::int64_t>(count))) {
    throw CliError(kUsage, fmt::format("--count {}: allowed are whole numbers from 1",
                                       invocation.Text("count")));
  }
  return static_cast<std::int64_t>(count);
}

ExitCode Watch(Context& context, const Invocation& invocation) {
  return Stream(context, invocation.params.at("topic"), invocation.params, Count(invocation));
}

ExitCode Events(Context& context, const Invocation& invocation) {
  if (invocation.Has("follow")) {
    return Stream(context, "events", {{"topic", "events"}},
                  invocation.params.value("count", std::int64_t{0}));
  }
  const Json answer = context.Call(invocation);
  const Json& events = At(answer, "events");
  context.PrintRows(answer, {events.begin(), events.end()}, [&] {
    for (const auto& event : events) context.out().Line(EventLine(context.out(), event));
  });
  return kOk;
}

}  // namespace

std::vector<CommandSpec> InspectCommands() {
  const Arg follow = {.key = "follow",
                      .flags = "-f,--follow",
                      .metavar = "",
                      .kind = ArgKind::kFlag,
                      .help = "print new events as they come, until interrupted"};
  const Arg count = {.key = "count",
                     .flags = "--count",
                     .metavar = "N",
                     .kind = ArgKind::kText,
                     .help = "end after so many samples",
                     .default_text = "until interrupted"};
  CommandSpec wait =
      MethodCommand("job.wait", kGroup, JobWait, {.positional = {"id"}, .hidden = {"timeout_s"}});
  wait.sentence = "wait until a job has ended, print its record";
  CommandSpec watch =
      MethodCommand("subscribe", kGroup, Watch, {.positional = {"topic"}, .extra = {count}});
  watch.sentence = "print a topic again and again";
  return {
      MethodCommand("status", kGroup, Status),
      MethodCommand("contacts", kGroup, Contacts),
      MethodCommand("joints", kGroup, Joints),
      MethodCommand("quality", kGroup, Quality),
      MethodCommand("shape", kGroup, Shape,
                    {.hidden = {"mesh"},
                     .extra = {{.key = "output",
                                .flags = "-o,--output",
                                .metavar = "FILE",
                                .help = "write the surface as a closed mesh, in metres; the suffix "
                                        "decides: .ply (with what is unknown, and the error), .stl",
                                .default_text = "print what is known of it"}}}),
      MethodCommand("truth", kGroup, Truth),
      MethodCommand("job.list", kGroup, JobList),
      MethodCommand("job.get", kGroup, JobShow, {.positional = {"id"}}),
      wait,
      MethodCommand("job.cancel", kGroup, JobShow, {.positional = {"id"}}),
      MethodCommand("events", kGroup, Events, {.extra = {follow}}),
      watch,
      {"top",
       kGroup,
       "the run on a full screen: fingers, curves, events; keys to act",
       nullptr,
       {},
       Top},
  };
}

}  // namespace regrasp::cli
