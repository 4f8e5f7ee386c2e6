// Inspect: the state of the moment.

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numbers>

#include "cli/client/context.h"
#include "cli/commands/jobs.h"
#include "cli/commands/parameters.h"
#include "cli/commands/shape.h"
#include "cli/commands/watch.h"
#include "cli/help/wrap.h"
#include "cli/top/top.h"
#include "core/common/count_text.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr const char* kGroup = "Inspect";

Style StateStyle(const std::string& state) {
  if (state == "dropped" || state == "faulted") return Style::kBad;
  return state == "idle" ? Style::kPlain : Style::kGood;
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
    if (!changed.empty()) line("changed", changed + context.Next("regrasp param list --changed"));
    if (At(s, "recording").is_string())
      line("recording", Plain(At(s, "recording")) + context.Next("regrasp record stop"));
    const Json& incident = At(s, "incident");
    if (incident.is_object() && (state == "dropped" || state == "faulted"))
      line("incident", Plain(At(incident, "record")) + context.Next("regrasp plot incident"));
    line("daemon",
         fmt::format("regraspd {} on {}, {}", Plain(At(s, "version")), context.client().path(),
                     CountText(Plain(At(s, "clients")), "client")));
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

}  // namespace

std::vector<CommandSpec> InspectCommands() {
  std::vector<CommandSpec> commands = {
      MethodCommand("status", kGroup, Status),
      MethodCommand("contacts", kGroup, Contacts),
      MethodCommand("joints", kGroup, Joints),
      MethodCommand("quality", kGroup, Quality),
      ShapeCommand(),
      MethodCommand("truth", kGroup, Truth),
  };
  std::ranges::move(JobCommands(), std::back_inserter(commands));
  std::ranges::move(WatchCommands(), std::back_inserter(commands));
  commands.push_back({"top",
                      kGroup,
                      "the run on a full screen: fingers, curves, events; keys to act",
                      nullptr,
                      {},
                      Top});
  return commands;
}

}  // namespace regrasp::cli
