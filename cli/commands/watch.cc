#include "cli/commands/watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "cli/client/context.h"
#include "cli/commands/jobs.h"
#include "core/files/json_text.h"

namespace regrasp::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr const char* kGroup = "Inspect";

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

/// Where a null stands for a vector, and how many numbers that has.
std::size_t SizeOfVector(const std::string& name) {
  if (name.starts_with("q_")) return 4;
  const bool vector = name.starts_with("p_") || name.find("_W") != std::string::npos;
  return vector ? 3 : 0;
}

/// `value` with a cell for each number that it may have; what differs in its members from one time
/// to another is a cell of JSON.
Json Settled(const std::string& name, const Json& value) {
  static constexpr std::string_view kDiffers[] = {
      "contacts", "changed_parameters", "exploration", "gait", "incident", "more", "warnings"};
  if (value.is_null() && SizeOfVector(name) > 0) return std::vector<Json>(SizeOfVector(name));
  if (value.is_structured() && std::ranges::find(kDiffers, name) != std::end(kDiffers))
    return JsonText(value);
  if (!value.is_object()) return value;
  Json settled = Json::object();
  for (const auto& [key, item] : value.items()) settled[key] = Settled(key, item);
  return settled;
}

/// A sample as a row of a table that has the same columns always, whatever goes on.
Json CsvRow(const std::string& topic, Json sample) {
  static constexpr const char* kOfEveryJob[] = {"id",       "method",     "state",   "error",
                                                "progress", "start_tick", "end_tick"};
  if (topic == "status") {
    Json job = Json::object(), more = At(sample, "job");
    for (const char* key : kOfEveryJob) {
      job[key] = At(more, key);
      if (more.is_object()) more.erase(key);
    }
    job["more"] = more;
    sample["job"] = job;
  }
  return Settled("", sample);
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
      const bool csv = context.out().format() == Format::kCsv;
      context.Print(csv ? CsvRow(topic, *sample) : *sample,
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

std::vector<CommandSpec> WatchCommands() {
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
  CommandSpec watch =
      MethodCommand("subscribe", kGroup, Watch, {.positional = {"topic"}, .extra = {count}});
  watch.sentence = "print a topic again and again";
  return {MethodCommand("events", kGroup, Events, {.extra = {follow}}), watch};
}

}  // namespace regrasp::cli
