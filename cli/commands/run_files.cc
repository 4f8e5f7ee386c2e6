// Run files: recording is the daemon's, the rest is done by regrasp-run.

#include "cli/commands/run_files.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "cli/client/context.h"
#include "cli/client/program.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;
constexpr const char* kGroup = "Results";

ExitCode RecordStart(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    context.out().Line(fmt::format("recording {} at {} Hz, with {} earlier commands",
                                   Plain(At(answer, "path")), Plain(At(answer, "rate_hz")),
                                   Plain(At(answer, "commands"))));
  });
  return kOk;
}

ExitCode RecordStop(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  context.Print(answer, [&] {
    context.out().Line(
        fmt::format("{}: {} messages, {} MB{}", Plain(At(answer, "path")),
                    Plain(At(answer, "messages")), Fixed(At(answer, "bytes"), 1, 1e-6),
                    At(answer, "dropped") == 0
                        ? ""
                        : fmt::format(", {} samples lost", Plain(At(answer, "dropped")))));
  });
  return kOk;
}

ExitCode RecordList(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  const auto& list = At(answer, "recordings");
  context.PrintRows(answer, std::vector<Json>(list.begin(), list.end()), [&] {
    if (list.empty()) return context.out().Line("no run file    (regrasp record start)");
    Table table({"file", ">size [MB]", ""});
    for (const Json& row : list)
      table.Row({Plain(At(row, "file")), Fixed(At(row, "bytes"), 1, 1e-6),
                 At(row, "recording") == true  ? "being written"
                 : At(row, "complete") == true ? "complete"
                                               : "without an end: its writer was killed"});
    context.out().Add(table.Text(context.out()));
  });
  return kOk;
}

/// The run file: a path, or the name of one in the output directory of the daemon that answers.
std::string FindRun(Context& context, const std::string& name) {
  if (fs::exists(name) || name.find('/') != std::string::npos) return name;
  fs::path directory;
  try {
    directory = Plain(At(context.client().Call("status", Json::object()), "output_dir"));
  } catch (const CliError&) {
    throw CliError(kNotFound, fmt::format("no file {}, and no daemon to ask for it", name),
                   "give the path of a run file");
  }
  for (const fs::path& path : {directory / name, directory / (name + ".mcap")})
    if (fs::exists(path)) return path;
  throw CliError(kNotFound, fmt::format("no file {} here or in {}", name, directory.string()),
                 "regrasp record list");
}

ExitCode Run(Context& context, const Invocation& invocation,
             const std::vector<std::string>& defaults = {}) {
  const std::string file = FindRun(context, invocation.Text("run"));
  std::vector<std::string> arguments = {FindHelper("regrasp-run"), invocation.command->words, file};
  arguments.insert(arguments.end(), defaults.begin(), defaults.end());
  for (const Arg& arg : invocation.command->args) {
    if (arg.key == "run" || !invocation.Has(arg.key)) continue;
    arguments.push_back("--" + arg.key);
    arguments.push_back(invocation.Text(arg.key));
  }
  if (context.out().format() == Format::kJson) arguments.push_back("--json");
  if (context.options().quiet) arguments.push_back("--quiet");
  const int code = WaitForEnd(Start(arguments));
  if (code > 128)
    throw CliError(kFailed, fmt::format("regrasp-run ended by signal {}", code - 128), "try again");
  return static_cast<ExitCode>(code);
}

ExitCode Replay(Context& context, const Invocation& invocation) {
  const std::string speed = invocation.Text("speed");
  if (!speed.empty() && speed != "max" && ParseNumber(speed, "--speed") <= 0)
    throw CliError(kUsage, fmt::format("--speed {}: expected more than 0, or max", speed),
                   "regrasp replay RUN --speed 10");
  if (speed != "max") return Run(context, invocation);
  Invocation without = invocation;
  without.local.erase("speed");
  return Run(context, without);
}

ExitCode Export(Context& context, const Invocation& invocation) {
  if (invocation.Has("output")) return Run(context, invocation);
  // Beside nobody's files: into the present directory, under the run's own name.
  const std::string format = invocation.Text("format");
  const std::string stem = fs::path(invocation.Text("run")).stem();
  const std::string out = format == "csv"   ? stem + "-csv"
                          : format == "npz" ? stem + ".npz"
                                            : stem + "-export.mcap";
  return Run(context, invocation, {"--output", out});
}

ExitCode Video(Context& context, const Invocation& invocation) {
  for (const char* key : {"fps", "speed", "from", "to"})
    if (invocation.Has(key)) {
      const double value = ParseNumber(invocation.Text(key), std::string("--") + key);
      const bool rate = *key == 'f' && key[1] == 'p' ? true : *key == 's';
      if (value < 0 || (rate && value == 0))
        throw CliError(kUsage,
                       fmt::format("--{} {}: expected {}", key, invocation.Text(key),
                                   rate ? "more than 0" : "0 or more"),
                       "regrasp help video");
    }
  return Run(context, invocation);
}

Arg RunArg() {
  Arg run =
      TextArg("run", "", "RUN", "a run file: a path, or a name in the daemon's output directory");
  run.required = true;
  return run;
}

}  // namespace

std::vector<CommandSpec> RunFileCommands() {
  Arg format = TextArg("format", "--format", "NAME", "csv: a directory with a file per topic");
  format.values = {"csv", "npz", "mcap"};
  format.required = true;
  Arg film = TextArg("output", "-o,--output", "FILE", "the film, .mp4");
  film.required = true;
  return {
      MethodCommand("record.start", kGroup, RecordStart, {.positional = {"file"}}),
      MethodCommand("record.stop", kGroup, RecordStop),
      MethodCommand("record.list", kGroup, RecordList),
      {"replay",
       kGroup,
       "re-execute a run file and compare every recorded state",
       nullptr,
       {RunArg(), TextArg("speed", "--speed", "X|max", "times real time", "max")},
       Replay},
      {"export",
       kGroup,
       "turn a run file into CSV, NumPy arrays or a whole MCAP file",
       nullptr,
       {RunArg(), format,
        TextArg("output", "-o,--output", "PATH", "where to write; must not exist",
                "named after the run, in this directory")},
       Export},
      {"video",
       kGroup,
       "film a run file: scene and curves",
       nullptr,
       {RunArg(), film, TextArg("fps", "--fps", "N", "pictures per second", "25"),
        TextArg("speed", "--speed", "X", "seconds of the run per second of film", "1"),
        TextArg("from", "--from", "S", "begin at this simulated time", "0"),
        TextArg("to", "--to", "S", "end at this simulated time", "the end of the run")},
       Video},
  };
}

}  // namespace regrasp::cli
