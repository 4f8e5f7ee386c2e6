// regrasp-run: what `regrasp` does with run files that needs the simulation or pictures. `regrasp`
// checks the arguments and executes it.

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "cli/run/export_run.h"
#include "cli/run/replay_run.h"
#include "cli/run/video.h"
#include "core/files/names.h"
#include "core/journal/journal_text.h"
#include "core/journal/provenance.h"
#include "core/protocol/errors.h"

namespace regrasp::run {
namespace {

using Json = nlohmann::ordered_json;
using Options = std::map<std::string, std::string>;

struct Command {
  std::string verb, file;
  Options options;  ///< "--speed" -> "1.0"; flags -> ""
  bool json() const { return options.contains("--json"); }
};

void Print(const Command& command, const Json& result, const std::string& text) {
  if (!command.options.contains("--quiet"))
    fmt::print("{}\n", command.json() ? result.dump() : text);
  if (std::fflush(stdout) != 0)
    throw std::runtime_error(std::string("cannot write to standard output: ") +
                             std::strerror(errno));
}

/// First of all: what a run was made with, where that is not what this program has. Each once.
void TellDifferences(const SessionConfig& config, const std::string& build, Json* told) {
  for (const std::string& difference : Differences(config, build, ModelSearchPath(""))) {
    if (std::find(told->begin(), told->end(), difference) != told->end()) continue;
    told->push_back(difference);
    fmt::print(stderr, "regrasp: note: {}\n", difference);
  }
}

Json TellDifferences(const RunFile& file) {
  Json told = Json::array();
  for (const Segment& segment : file.segments)
    TellDifferences(segment.journal->config, segment.build, &told);
  return told;
}

/// Of a run that is only exported, a configuration that cannot be used is no reason to stop.
void TellDifferences(std::string_view config, Json* told) {
  try {
    const ConfigRead run = ParseConfig(config);
    TellDifferences(run.config, run.build, told);
  } catch (const JournalError& e) {
    const std::string difference =
        fmt::format("the configuration of the run cannot be used here: {}", e.what());
    told->push_back(difference);
    fmt::print(stderr, "regrasp: note: {}\n", difference);
  }
}

Json LossesJson(const std::vector<McapLoss>& lost) {
  Json list = Json::array();
  for (const McapLoss& loss : lost)
    list.push_back(
        {{"offset", loss.offset},
         {"bytes", loss.bytes},
         {"start_s", loss.end != 0 ? Json(static_cast<double>(loss.start) * 1e-9) : Json()},
         {"end_s", loss.end != 0 ? Json(static_cast<double>(loss.end) * 1e-9) : Json()},
         {"cause", loss.cause}});
  return list;
}

std::string LossesText(const std::vector<McapLoss>& lost) {
  std::string text;
  for (const McapLoss& loss : lost) text += "\n  lost: " + LossText(loss);
  return text;
}

ExitCode ReplayCommand(const Command& command) {
  const RunFile file = ReadRunFile(command.file);
  const Json differences = TellDifferences(file);
  OnState pace;
  if (const auto speed = command.options.find("--speed"); speed != command.options.end()) {
    using Clock = std::chrono::steady_clock;
    const double factor = std::strtod(speed->second.c_str(), nullptr);
    pace = [factor, start = Clock::now()](int, Session& session) {
      const double due = static_cast<double>(session.tick()) * session.config().world.dt / factor;
      std::this_thread::sleep_until(
          start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(due)));
    };
  }
  const ReplayResult result = ReplayRun(file, pace);
  const Segment& segment = file.segments[static_cast<std::size_t>(result.segment)];
  const bool same_build = segment.build == BuildIdentity();
  const double seconds =
      static_cast<double>(result.ticks) * file.segments[0].journal->config.world.dt;
  const std::string verdict = Verdict(file, result);
  Json json = {{"file", command.file},
               {"identical", !result.divergence.has_value()},
               {"segments", file.segments.size()},
               {"commands", result.commands},
               {"ticks", result.ticks},
               {"time_s", seconds},
               {"states_compared", result.compared},
               {"complete", file.complete},
               {"build", segment.build},
               {"same_build", same_build},
               {"differences", differences},
               {"lost", LossesJson(file.lost)},
               {"first_difference", nullptr}};
  if (const auto& d = result.divergence)
    json["first_difference"] = {{"segment", result.segment},
                                {"tick", d->tick},
                                {"command", d->command >= 0 ? Json(d->command) : Json()},
                                {"last_equal_tick", d->last_equal},
                                {"recorded", HashText(d->recorded)},
                                {"found", HashText(d->found)}};
  std::string text =
      fmt::format("{}: {}\n  {} commands, {:.3f} s ({} ticks), {} states compared", command.file,
                  verdict, result.commands, seconds, result.ticks, result.compared);
  if (!file.complete) text += "\n  the file has no end: its writer was killed";
  text += LossesText(file.lost);
  if (!same_build)
    text += fmt::format("\n  recorded by {}\n  replayed by {}", segment.build, BuildIdentity());
  Print(command, json, text);
  return result.divergence || !file.lost.empty() ? ExitCode::kFailed : ExitCode::kOk;
}

ExitCode ExportCommand(const Command& command) {
  const std::string& format = command.options.at("--format");
  const std::string& out = command.options.at("--output");
  Json differences = Json::array();
  const ExportResult result = ExportRun(command.file, format, out, [&](std::string_view config) {
    TellDifferences(config, &differences);
  });
  Print(command,
        {{"path", out},
         {"format", format},
         {"messages", result.messages},
         {"files", result.files},
         {"complete", result.complete},
         {"differences", differences},
         {"lost", LossesJson(result.lost)}},
        fmt::format("{}: {} messages{}", out, result.messages,
                    format == "csv" ? fmt::format(" in {} files", result.files) : "") +
            LossesText(result.lost));
  return result.lost.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

double Number(const Command& command, const char* name, double otherwise) {
  const auto found = command.options.find(name);
  return found == command.options.end() ? otherwise : std::strtod(found->second.c_str(), nullptr);
}

ExitCode VideoCommand(const Command& command) {
  const RunFile file = ReadRunFile(command.file);
  const Json differences = TellDifferences(file);
  VideoOptions options;
  options.fps = Number(command, "--fps", options.fps);
  options.speed = Number(command, "--speed", options.speed);
  options.from_s = Number(command, "--from", options.from_s);
  options.to_s = Number(command, "--to", options.to_s);
  const std::string& out = command.options.at("--output");
  const VideoResult result = WriteVideo(file, options, out);
  Print(command,
        {{"path", out},
         {"frames", result.frames},
         {"duration_s", result.duration_s},
         {"differences", differences},
         {"lost", LossesJson(file.lost)}},
        fmt::format("{}: {} frames, {:.1f} s", out, result.frames, result.duration_s) +
            LossesText(file.lost));
  return file.lost.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

int Main(int argc, char** argv) {
  Command command;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--json" || argument == "--quiet")
      command.options[argument] = "";
    else if (argument.starts_with("--") && i + 1 < argc)
      command.options[argument] = argv[++i];
    else
      (command.verb.empty() ? command.verb : command.file) = argument;
  }
  try {
    if (command.verb == "replay") return static_cast<int>(ReplayCommand(command));
    if (command.verb == "export") return static_cast<int>(ExportCommand(command));
    if (command.verb == "video") return static_cast<int>(VideoCommand(command));
    fmt::print(stderr, "regrasp-run: unknown verb '{}'\n  try: regrasp help replay\n",
               command.verb);
    return static_cast<int>(ExitCode::kUsage);
  } catch (const std::exception& e) {
    if (command.json())
      fmt::print(stderr, "{}\n", Json{{"error", {{"message", e.what()}}}}.dump());
    else
      fmt::print(stderr, "regrasp: {}\n  try: regrasp record list\n", e.what());
    return static_cast<int>(ExitCode::kIo);
  }
}

}  // namespace
}  // namespace regrasp::run

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error, not the end
  return regrasp::run::Main(argc, argv);
}
