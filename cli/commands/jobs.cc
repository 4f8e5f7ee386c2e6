#include "cli/commands/jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "cli/help/wrap.h"
#include "cli/print/progress_line.h"
#include "core/common/count_text.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

std::string JobTitle(const Json& record) {
  std::string title = Plain(At(record, "method"));
  if (At(record, "finger").is_string()) title += " " + Plain(At(record, "finger"));
  return title;
}

std::string ProgressText(Context& context, const Json& record) {
  Output& out = context.out();
  const double progress = record.value("progress", 0.0);
  std::string text =
      fmt::format("{}  {} {:3.0f} %", JobTitle(record), out.Bar(progress, 30), 100 * progress);
  if (record.value("method", "") == "rotate" && At(record, "angle_rad").is_number()) {
    text += fmt::format("  {}{}", Fixed(At(record, "angle_rad"), 1, kDegrees), out.Degree());
  }
  if (record.value("method", "") == "explore") {
    const Json quality = context.client().Call("quality", Json::object());
    const Json& finger = At(At(quality, "fingers"), Plain(At(record, "finger")).c_str());
    text += fmt::format("  {} {}", out.Phi(), Fixed(At(finger, "manipulability"), 3));
  }
  return text;
}

std::string Change(const Output& out, const Json& from, const Json& to) {
  if (!from.is_number() || !to.is_number()) return "-";
  const double a = from, b = to;
  std::string text = fmt::format("{:.4f} to {:.4f}", a, b);
  if (a > 0)
    text += "  " + out.Paint(fmt::format("{:+.1f} %", 100 * (b - a) / a),
                             b > a ? Style::kGood : Style::kWarn);
  return text;
}

void PrintExplore(Output& out, const Json& r) {
  out.Line(fmt::format("  criterion  {}", Plain(At(r, "criterion"))));
  out.Line(fmt::format("  {}   {}", out.Phi() == "phi" ? "phi     " : "φ       ",
                       Change(out, At(r, "phi_initial"), At(r, "phi_final"))));
  out.Line(fmt::format("  noise-free {}",
                       Change(out, At(r, "phi_true_initial"), At(r, "phi_true_final"))));
  out.Line(fmt::format("  path       {} mm in {}", Fixed(At(r, "path_length_m"), 1, 1e3),
                       CountText(Plain(At(r, "cycles")), "cycle")));
  out.Line(fmt::format("  seed       {}", Plain(At(r, "seed"))));
}

void PrintRotate(Output& out, const Json& r) {
  out.Line(fmt::format("  angle      {}{} ({} turns) in {} s",
                       Fixed(At(r, "angle_rad"), 1, kDegrees), out.Degree(),
                       Fixed(At(r, "turns"), 2), Fixed(At(r, "sim_time_s"), 1)));
  out.Line(fmt::format("  gait       {}, {}", CountText(Plain(At(r, "gait_cycles")), "cycle"),
                       CountText(Plain(At(r, "regrasps")), "regrasp")));
  out.Line(fmt::format("  error      at most {} mm, tilt {}{}",
                       Fixed(At(r, "max_position_error_m"), 1, 1e3),
                       Fixed(At(r, "max_tilt_rad"), 1, kDegrees), out.Degree()));
  if (At(r, "reference_resets").is_number() && At(r, "reference_resets") != 0)
    out.Line(
        fmt::format("  reference  followed the object {} times, which was at most {} mm behind",
                    Plain(At(r, "reference_resets")), Fixed(At(r, "max_lag_m"), 1, 1e3)));
}

void PrintMove(Output& out, const Json& r) {
  out.Line(fmt::format("  shift      {} mm of {} mm", Vector(At(r, "achieved_offset_m"), 2, 1e3),
                       Vector(At(r, "offset_m"), 2, 1e3)));
  out.Line(fmt::format("  turn       {}{} of {}{}",
                       Vector(At(r, "achieved_rotation_rad"), 1, kDegrees), out.Degree(),
                       Vector(At(r, "rotation_rad"), 1, kDegrees), out.Degree()));
  out.Line(fmt::format("  error      at most {} mm, {}{}, in {} s",
                       Fixed(At(r, "max_position_error_m"), 1, 1e3),
                       Fixed(At(r, "max_rotation_error_rad"), 1, kDegrees), out.Degree(),
                       Fixed(At(r, "sim_time_s"), 1)));
}

/// How a move ended: "reached", "at a joint limit of middle".
std::string MoveResult(const Json& r) {
  const std::string end = Plain(At(r, "end")), finger = Plain(At(r, "end_finger"));
  if (end == "joint_limit") return "at a joint limit of " + finger;
  if (end == "manipulability") return finger + " is near a singular posture";
  if (end == "excursion") return finger + " is too far from its first place";
  if (end == "load_margin") return "the load margin is too small";
  if (end == "object_stuck") return "the object does not follow";
  return end;
}

/// What became of a move that is done: "done, reached", "ended at a joint limit of middle".
std::string MoveVerdict(const Json& r) {
  const std::string end = Plain(At(r, "end"));
  const char* begin = end == "reached" ? "done, " : end == "joint_limit" ? "ended " : "ended, ";
  return begin + MoveResult(r);
}

/// Throws CliError(kRefused) when the job has not begun because the simulation is paused.
void CheckNotPaused(Context& context, std::int64_t id) {
  const Json job = context.client().Call("job.get", {{"id", id}});
  if (At(job, "state") != "queued") return;
  const Json status = context.client().Call("status", Json::object());
  if (At(status, "paused") != true) return;
  throw CliError(kRefused,
                 fmt::format("the simulation is paused: job {} waits for it to go on", id),
                 "regrasp resume, or regrasp step --until-job-ends --wait");
}

}  // namespace

ExitCode JobExit(const Json& record) {
  const std::string state = record.value("state", "");
  if (state == "failed" || state == "cancelled") return kFailed;
  if (At(record, "converged") == false || At(record, "dropped") == true ||
      At(record, "reached") == false)
    return kFailed;
  return kOk;
}

void PrintJob(Context& context, const Json& record) {
  Output& out = context.out();
  const std::string state = record.value("state", "");
  const bool ended = state != "queued" && state != "running";
  const bool good = JobExit(record) == kOk;
  std::string verdict = state;
  if (state == "done" && At(record, "converged").is_boolean()) {
    verdict = (good ? "converged" : "not converged");
    verdict += fmt::format(" ({})", Plain(At(record, "reason")));
  } else if (state == "done" && At(record, "dropped") == true) {
    verdict = "dropped the object";
  } else if (state == "done" && At(record, "reached").is_boolean()) {
    verdict = MoveVerdict(record);
  } else if (!ended) {
    verdict += fmt::format(" {:.0f} %", 100 * record.value("progress", 0.0));
  }
  out.Line(fmt::format("job {}: {} {}", Plain(At(record, "id")),
                       out.Paint(JobTitle(record), Style::kBold),
                       out.Paint(verdict, !ended ? Style::kPlain
                                          : good ? Style::kGood
                                                 : Style::kBad)));
  if (At(record, "error").is_string()) out.Line("  error      " + Plain(At(record, "error")));
  if (const Json& incident = At(record, "incident"); incident.is_object()) {
    out.Add(Wrap("  cause      " + Plain(At(incident, "cause")), 13));
    out.Line("  incident   " + Plain(At(incident, "record")) +
             context.Next("regrasp plot incident"));
  }
  if (ended && record.value("method", "") == "explore" && state == "done")
    PrintExplore(out, record);
  if (ended && record.value("method", "") == "rotate" && At(record, "angle_rad").is_number())
    PrintRotate(out, record);
  if (ended && record.value("method", "") == "move" && At(record, "end").is_string())
    PrintMove(out, record);
  if (At(record, "start_tick").is_number()) {
    const std::string start = Plain(At(record, "start_tick"));
    out.Line(ended ? fmt::format("  ticks      {} to {}", start, Plain(At(record, "end_tick")))
                   : fmt::format("  ticks      from {}", start));
  }
}

Json WaitForJob(Context& context, std::int64_t id, Standstill standstill) {
  constexpr double kFirstSlice_s = 0.25;
  const Interruptible interruptible;
  ProgressLine line(context.out().human() && !context.options().quiet);
  const auto deadline = Deadline(context.options().timeout_s.value_or(0));
  const std::string how = fmt::format("regrasp job wait {}", id);
  try {
    while (true) {
      const double left = std::chrono::duration<double>(deadline - Clock::now()).count();
      const bool first = standstill == Standstill::kRefuse;
      const double slice = std::clamp(left, 0.0, first ? kFirstSlice_s : line.on() ? 0.1 : 60.0);
      try {
        return context.client().Call("job.wait", {{"id", id}, {"timeout_s", slice}}, slice + 10);
      } catch (const CliError& error) {
        if (error.code != kTimeout || error.rpc_code == 0) throw;
        if (slice >= left || Clock::now() >= deadline) {
          throw CliError(kTimeout,
                         fmt::format("job {} has not ended after {:g} s; it goes on", id,
                                     *context.options().timeout_s),
                         how);
        }
        if (first) CheckNotPaused(context, id);
        standstill = Standstill::kWait;
      }
      if (line.on())
        line.Show(ProgressText(context, context.client().Call("job.get", {{"id", id}})));
    }
  } catch (const CliError& error) {
    if (error.code != kInterrupted) throw;
    throw CliError(kInterrupted, fmt::format("interrupted; job {} goes on", id), how);
  }
}

ExitCode StartJob(Context& context, const Invocation& invocation) {
  const bool wait = invocation.Has("wait");
  const Json answer = context.Call(invocation);
  const std::int64_t id = answer.at("job");
  for (const Json& difference : answer.value("differences", Json::array()))
    fmt::print(stderr, "regrasp: note: {}\n", Plain(difference));
  if (!wait) {
    context.Print(answer, [&] {
      context.out().Line(fmt::format("job {}: {} started{}", id, invocation.command->words,
                                     context.Next(fmt::format("regrasp job wait {}", id))));
    });
    return kOk;
  }
  const bool step = invocation.command->words == "step";
  const Json record = WaitForJob(context, id, step ? Standstill::kWait : Standstill::kRefuse);
  context.Print(record, [&] { PrintJob(context, record); });
  return JobExit(record);
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

namespace {

constexpr const char* kGroup = "Inspect";

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
      if (At(job, "end").is_string()) result = MoveResult(job);
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
  context.Print(record, [&] { PrintJob(context, record); });
  return kOk;
}

ExitCode JobWait(Context& context, const Invocation& invocation) {
  const Json record = WaitForJob(context, invocation.params.at("id"));
  context.Print(record, [&] { PrintJob(context, record); });
  return JobExit(record);
}

}  // namespace

std::vector<CommandSpec> JobCommands() {
  CommandSpec wait =
      MethodCommand("job.wait", kGroup, JobWait, {.positional = {"id"}, .hidden = {"timeout_s"}});
  wait.sentence = "wait until a job has ended, print its record";
  return {MethodCommand("job.list", kGroup, JobList),
          MethodCommand("job.get", kGroup, JobShow, {.positional = {"id"}}), wait,
          MethodCommand("job.cancel", kGroup, JobShow, {.positional = {"id"}})};
}

}  // namespace regrasp::cli
