// Run files: recording is the daemon's, the rest is done by regrasp-run.

#include "cli/commands/run_files.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <system_error>

#include "cli/client/context.h"
#include "cli/client/program.h"
#include "cli/grammar/units.h"
#include "core/common/count_text.h"
#include "core/common/nearest_name.h"
#include "core/files/lower_suffix.h"
#include "core/files/shell_word.h"
#include "core/mcap/without_end.h"

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
    context.out().Line(fmt::format(
        "{}: {}, {} MB{}", Plain(At(answer, "path")),
        CountText(Plain(At(answer, "messages")), "message"), Fixed(At(answer, "bytes"), 1, 1e-6),
        At(answer, "dropped") == 0
            ? ""
            : fmt::format(", {} lost", CountText(Plain(At(answer, "dropped")), "sample"))));
  });
  return kOk;
}

ExitCode RecordList(Context& context, const Invocation& invocation) {
  const Json answer = context.Call(invocation);
  const auto& list = At(answer, "recordings");
  context.PrintRows(answer, std::vector<Json>(list.begin(), list.end()), [&] {
    if (list.empty())
      return context.out().Line("no run file" + context.Next("regrasp record start"));
    Table table({"file", ">size [MB]", ""});
    for (const Json& row : list)
      table.Row({Plain(At(row, "file")), Fixed(At(row, "bytes"), 1, 1e-6),
                 At(row, "recording") == true ? "being written"
                 : At(row, "complete") == true
                     ? "complete"
                     : fmt::format("without an end: {}", kWhyWithoutEnd)});
    context.out().Add(table.Text(context.out()));
  });
  return kOk;
}

ExitCode Run(Context& context, const Invocation& invocation,
             const std::vector<std::string>& defaults = {}) {
  context.RefuseCsv(invocation);
  const std::string file = FindRun(context, invocation.Text("run"));
  const bool film = invocation.command->words == "video";
  std::vector<std::string> arguments = {FindHelper(film ? "regrasp-film" : "regrasp-run"),
                                        invocation.command->words, file};
  arguments.insert(arguments.end(), defaults.begin(), defaults.end());
  for (const Arg& arg : invocation.command->args) {
    if (arg.key == "run" || !invocation.Has(arg.key)) continue;
    arguments.push_back("--" + arg.key);
    arguments.push_back(invocation.Text(arg.key, "yes"));
  }
  const std::string output = invocation.Text("output", defaults.empty() ? "" : defaults.back());
  context.AddCommon(&arguments);
  return RunHelper(arguments, output);
}

/// The command's options in the units that the helper takes, checked.
Invocation Checked(const Invocation& invocation) {
  Invocation checked = invocation;
  const auto check = [&](const char* key, std::string_view unit, double least, bool included) {
    if (!invocation.Has(key)) return;
    const std::string text = invocation.Text(key), flag = std::string("--") + key;
    const double value = ParseQuantity(text, flag, unit);
    if (value < least || (value == least && !included))
      throw CliError(kUsage,
                     fmt::format("{} {}: expected {}", flag, text,
                                 included ? fmt::format("{:g} or more", least)
                                          : fmt::format("more than {:g}", least)),
                     "regrasp help " + invocation.command->words);
    checked.local[key] = fmt::format("{}", value);
  };
  if (invocation.Text("speed") == "max")
    checked.local.erase("speed");
  else
    check("speed", "", 0, false);
  check("fps", "Hz", 0, false);
  check("rate", "Hz", 0, false);
  check("from", "s", 0, true);
  check("to", "s", 0, false);
  const auto number = [&](const char* key) { return std::stod(checked.Text(key)); };
  if (checked.Has("from") && checked.Has("to") && number("to") <= number("from"))
    throw CliError(kUsage,
                   fmt::format("--to {}: expected more than --from {}", invocation.Text("to"),
                               invocation.Text("from")),
                   "regrasp help " + invocation.command->words);
  return checked;
}

/// `what` appears whole under its name or not at all, so it is no stream.
void RefuseStandardOutput(const Invocation& invocation, const char* what,
                          const std::string& instead) {
  if (invocation.Text("output") != "-") return;
  throw CliError(kUsage, fmt::format("-o -: {} is not written to standard output", what),
                 fmt::format("regrasp {} {} {}", invocation.command->words,
                             ShellWord(invocation.Text("run")), instead));
}

ExitCode Replay(Context& context, const Invocation& invocation) {
  return Run(context, Checked(invocation));
}

ExitCode Export(Context& context, const Invocation& typed) {
  const Invocation invocation = Checked(typed);
  RefuseStandardOutput(invocation, "an export",
                       fmt::format("--format {} -o PATH", invocation.Text("format")));
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
  RefuseStandardOutput(invocation, "a film", "-o FILE.mp4");
  const std::string out = invocation.Text("output"), suffix = LowerSuffix(out);
  if (suffix != ".mp4" && suffix != ".gif")
    throw CliError(kUsage, fmt::format("-o {}: a film ends in .mp4 or .gif", out),
                   fmt::format("regrasp video {} -o {}", ShellWord(invocation.Text("run")),
                               ShellWord(fs::path(out).replace_extension(".mp4").string())));
  return Run(context, Checked(invocation));
}

Arg RunArg() {
  Arg run =
      TextArg("run", "", "RUN", "a run file: a path, or a name in the daemon's output directory");
  run.required = true;
  return run;
}

}  // namespace

std::string FindRun(Context& context, const std::string& name) {
  const std::string with_suffix = name + ".mcap";
  if (fs::exists(name) && !fs::is_directory(name)) return name;
  if (fs::exists(with_suffix)) return with_suffix;
  if (name.find('/') != std::string::npos) return name;
  fs::path directory;
  try {
    directory = Plain(At(context.client().Call("status", Json::object()), "output_dir"));
  } catch (const CliError&) {
    throw CliError(kNotFound, fmt::format("no file {}, and no daemon to ask for it", name),
                   "give the path of a run file");
  }
  for (const fs::path& path : {directory / name, directory / with_suffix})
    if (fs::exists(path)) return path;
  std::vector<std::string> names;
  for (const fs::path& place : {fs::path("."), directory}) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(place, ignored))
      if (entry.path().extension() == ".mcap") names.push_back(entry.path().stem());
  }
  throw CliError(kNotFound,
                 fmt::format("no file {} here or in {}{}", name, directory.string(),
                             OrNearest(fs::path(name).stem().string(), names)),
                 "regrasp record list");
}

std::vector<CommandSpec> RunFileCommands() {
  Arg format = TextArg("format", "--format", "NAME", "csv: a directory with a file per topic");
  format.values = {"csv", "npz", "mcap"};
  format.required = true;
  Arg film = TextArg("output", "-o,--output", "FILE", "the film: .mp4 (H.264) or .gif");
  film.required = true;
  Arg scene_only;
  scene_only.key = "scene-only";
  scene_only.flags = "--scene-only";
  scene_only.kind = ArgKind::kFlag;
  scene_only.help = "without the curves below";
  const Arg from = TextArg("from", "--from", "S", "begin at this simulated time", "0");
  const Arg to = TextArg("to", "--to", "S", "end at this simulated time", "the end of the run");
  return {
      MethodCommand("record.start", kGroup, RecordStart, {.positional = {"file"}}),
      MethodCommand("record.stop", kGroup, RecordStop),
      MethodCommand("record.list", kGroup, RecordList),
      {"replay",
       kGroup,
       "re-execute a run file and compare every recorded state",
       nullptr,
       {RunArg(), TextArg("speed", "--speed", "X|max", "times real time", "max"), from, to},
       Replay},
      {"export",
       kGroup,
       "turn a run file into CSV, NumPy arrays or a whole MCAP file",
       nullptr,
       {RunArg(), format,
        TextArg("output", "-o,--output", "PATH", "where to write; must not exist",
                "named after the run, in this directory"),
        TextArg("rate", "--rate", "HZ",
                "execute again and sample so often, at most each tick (1000)", "as recorded"),
        from, to},
       Export},
      {"video",
       kGroup,
       "film a run file: scene and curves",
       nullptr,
       {RunArg(), film, TextArg("fps", "--fps", "N", "pictures per second", "25"),
        TextArg("speed", "--speed", "X", "seconds of the run per second of film", "1"), from, to,
        scene_only},
       Video},
  };
}

}  // namespace regrasp::cli
