// regrasp-run: what `regrasp` does with run files that needs the simulation: replay and export.

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "cli/run/export_run.h"
#include "cli/run/program.h"
#include "cli/run/replay_run.h"
#include "core/common/count_text.h"

namespace regrasp::run {
namespace {

/// Waits at every state until it is its time; empty: at full speed.
OnState Pace(const Command& command) {
  if (!command.Has("--speed")) return {};
  using Clock = std::chrono::steady_clock;
  struct Start {
    Clock::time_point wall;
    double time_s = -1;
  };
  return [factor = command.Number("--speed", 1), start = std::make_shared<Start>()](
             int, Session& session) {
    const double time_s = static_cast<double>(session.tick()) * session.config().world.dt;
    if (start->time_s < 0 || time_s < start->time_s) *start = {Clock::now(), time_s};
    const std::chrono::duration<double> due((time_s - start->time_s) / factor);
    std::this_thread::sleep_until(start->wall + std::chrono::duration_cast<Clock::duration>(due));
  };
}

ExitCode PrintReplay(const Command& command, const RunFile& file, const std::vector<McapLoss>& lost,
                     const ReplayResult& result, const Json& differences, const Json& extra,
                     const std::string& note) {
  const Segment& segment = file.segments[static_cast<std::size_t>(result.segment)];
  const bool same_build = segment.build == BuildIdentity();
  const double seconds =
      static_cast<double>(result.ticks) * file.segments[0].journal->config.world.dt;
  const std::string verdict = Verdict(file, result);
  Json json = {{"file", command.file},
               {"identical", result.identical()},
               {"segments", file.segments.size()},
               {"commands", result.commands},
               {"ticks", result.ticks},
               {"time_s", seconds},
               {"states_compared", result.compared},
               {"complete", file.complete},
               {"build", segment.build},
               {"same_build", same_build},
               {"differences", differences},
               {"lost", LossesJson(lost)},
               {"first_difference", nullptr},
               {"false_saved_state_tick", result.false_state ? Json(*result.false_state) : Json()}};
  json.update(extra);
  if (const auto& d = result.divergence)
    json["first_difference"] = {{"segment", result.segment},
                                {"tick", d->tick},
                                {"command", d->command >= 0 ? Json(d->command) : Json()},
                                {"last_equal_tick", d->last_equal},
                                {"recorded", HashText(d->recorded)},
                                {"found", HashText(d->found)}};
  std::string text =
      fmt::format("{}: {}\n  {}, {:.3f} s ({}), {} compared{}", command.file, verdict,
                  CountText(result.commands, "command"), seconds, CountText(result.ticks, "tick"),
                  CountText(result.compared, "state"), note);
  text += EndText(file.complete) + LossesText(lost);
  if (!same_build)
    text += fmt::format("\n  recorded by {}\n  replayed by {}", segment.build, BuildIdentity());
  Print(command, json, text);
  return result.identical() && lost.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

ExitCode ReplayStretch(const Command& command) {
  RunWindow window(command.file, command.stretch());
  const Json differences = TellDifferences(window.file());
  if (!window.note().empty()) Note(window.note());
  const ReplayResult result = window.ReplayStretch(Pace(command));
  const double start_s =
      static_cast<double>(window.start_tick()) * window.segment().journal->config.world.dt;
  return PrintReplay(command, window.file(), window.Losses(), result, differences,
                     {{"from", window.from_saved_state() ? "state" : "commands"},
                      {"from_tick", window.start_tick()},
                      {"end_tick", window.replay().session().tick()},
                      {"state_hash", HashText(window.replay().session().StateHash())}},
                     window.from_saved_state()
                         ? fmt::format("\n  from the state saved at {:.3f} s", start_s)
                         : "\n  from the start: no saved state before");
}

ExitCode ReplayCommand(const Command& command) {
  if (command.Has("--from") || command.Has("--to")) return ReplayStretch(command);
  const RunFile file = ReadRunFile(command.file);
  const Json differences = TellDifferences(file);
  const ReplayResult result = ReplayRun(file, Pace(command));
  return PrintReplay(command, file, file.lost, result, differences, Json::object(), "");
}

ExitCode ExportCommand(const Command& command) {
  ExportOptions options;
  options.format = command.options.at("--format");
  options.out = command.options.at("--output");
  options.stretch = command.stretch();
  options.rate_hz = command.Number("--rate", 0);
  options.whole = !command.Has("--from") && !command.Has("--to");
  Json differences = Json::array();
  const ExportResult result = ExportRun(command.file, options, [&](std::string_view config) {
    TellDifferences(config, &differences);
  });
  if (!result.note.empty()) Note(result.note);
  Print(command,
        {{"path", options.out},
         {"format", options.format},
         {"messages", result.messages},
         {"files", result.files},
         {"complete", result.complete},
         {"differences", differences},
         {"lost", LossesJson(result.lost)}},
        fmt::format("{}: {} messages{}", options.out, result.messages,
                    options.format == "csv" ? fmt::format(" in {} files", result.files) : "") +
            EndText(result.complete) + LossesText(result.lost));
  return result.lost.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace
}  // namespace regrasp::run

int main(int argc, char** argv) {
  using namespace regrasp::run;
  return RunVerb(argc, argv, {{"replay", ReplayCommand}, {"export", ExportCommand}});
}
