// Results: pictures.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "cli/client/context.h"
#include "cli/client/program.h"
#include "cli/commands/run_files.h"
#include "cli/grammar/units.h"
#include "cli/print/terminal_graphics.h"
#include "core/files/lower_suffix.h"
#include "core/files/output_file.h"
#include "core/files/read_file.h"
#include "core/files/shell_word.h"
#include "core/protocol/plot_table.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

/// Before anything is drawn.
void CheckTarget(const fs::path& target, const std::string& next) {
  try {
    CheckWritable(target, Draft::Existing::kReplace);
  } catch (const WriteError& e) {
    throw CliError(kIo, e.what(), next);
  }
}

/// The user named the target: what is there is replaced, at once and whole.
void Copy(const fs::path& picture, const fs::path& target, const std::string& next) {
  constexpr std::uint64_t kMaxPicture = 256u << 20;  // [bytes]
  std::error_code ignored;
  if (fs::equivalent(picture, target, ignored)) return;
  try {
    WriteWhole(target, ReadRegularFile(picture, kMaxPicture), Draft::Existing::kReplace);
  } catch (const std::exception& e) {
    throw CliError(
        kIo, fmt::format("cannot copy {} to {}: {}", picture.string(), target.string(), e.what()),
        next);
  }
}

std::string Bytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw CliError(kIo, "cannot read " + file, "ls -l " + file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// In which format a picture named so is, lower case: ".png"; empty: nothing says, for a directory
/// too. Refused where no picture ends so.
std::string CheckedSuffix(const std::string& output, const std::string& name) {
  const std::string suffix = LowerSuffix(output);
  std::error_code ignored;
  if (suffix.empty() || fs::is_directory(output, ignored)) return "";
  if (std::ranges::find(kPlotSuffixes, suffix) == kPlotSuffixes.end())
    throw CliError(
        kUsage, fmt::format("-o {}: a picture ends in {}", output, fmt::join(kPlotSuffixes, ", ")),
        fmt::format("regrasp plot {} -o {}", name,
                    ShellWord(fs::path(output).replace_extension(".png").string())));
  return suffix;
}

/// Of run files: no daemon is asked.
ExitCode PlotRuns(Context& context, const Invocation& invocation) {
  context.RefuseCsv(invocation);
  const std::string name = Plain(invocation.params["name"]);
  std::vector<std::string> words = {FindHelper("regrasp-film"), "plot", "--name", name};
  std::istringstream runs(invocation.Text("run"));
  for (std::string run; std::getline(runs, run);) words.push_back(FindRun(context, run));
  const auto number = [&](const char* key, const char* flag, double scale) {
    if (!invocation.params.contains(key)) return;
    words.insert(words.end(),
                 {flag, fmt::format("{}", invocation.params[key].get<double>() * scale)});
  };
  number("last_s", "--last", 1);
  number("size_m", "--size", 1e3);
  number("font_size_pt", "--font-size", 1);
  number("dpi", "--dpi", 1);
  if (invocation.params.value("title", true) == false)
    words.insert(words.end(), {"--no-title", ""});
  const std::string out = invocation.Text("output", name + ".png");
  words.insert(words.end(), {"--output", out});
  context.AddCommon(&words);
  const ExitCode code = RunHelper(words, out);
  // Of a damaged file the picture is there, too.
  if ((code == kOk || code == kFailed) && invocation.Has("show"))
    context.out().Add(DrawPicture(context, out));
  return code;
}

/// Refuses what only a printed width gives a meaning.
void CheckPrinted(const Invocation& invocation) {
  constexpr double kPageMm = 180, kPixels = 1600;  // across a page; as many as on a screen
  const Json& params = invocation.params;
  if (params.contains("size_m")) return;
  std::string what = Plain(params["name"]);
  if (invocation.Has("run")) what += " " + invocation.Text("run");
  std::ranges::replace(what, '\n', ' ');  // a line for each run
  for (const PrintedOnly& printed : kPrintedOnly) {
    const auto given = params.find(printed.name);
    if (given == params.end()) continue;
    const double value = given->get<double>();
    const double mm = printed.name == "dpi" ? std::max(50.0, kPixels / value * 25.4) : kPageMm;
    throw CliError(
        kUsage,
        fmt::format("{} {:g} says how a picture is printed, and --size is missing", printed.flag,
                    value),
        fmt::format("regrasp plot {} --size {:.0f}mm {} {:g}", what, mm, printed.flag, value));
  }
}

ExitCode Plot(Context& context, const Invocation& typed) {
  Invocation invocation = typed;
  if (typed.Has("font-size"))
    invocation.params["font_size_pt"] = ParseQuantity(typed.Text("font-size"), "--font-size", "pt");
  CheckPrinted(invocation);
  if (invocation.Has("show") && !context.out().human()) {
    throw CliError(kUsage, "--show draws for people: it goes with neither --json nor --csv",
                   "regrasp plot " + Plain(invocation.params["name"]) + " --show");
  }
  const bool to_stdout = invocation.Text("output") == "-";
  if (to_stdout && (invocation.Has("show") || !context.out().human()))
    throw CliError(kUsage,
                   "-o - writes the picture itself: it goes with none of --show, --json, --csv",
                   "regrasp plot " + Plain(invocation.params["name"]) + " -o - > FILE.png");
  if (invocation.Has("output") && invocation.Text("output").empty())
    throw CliError(kUsage, "-o '': a file needs a name",
                   "regrasp plot " + Plain(invocation.params["name"]) + " -o FILE.png");
  const std::string suffix =
      CheckedSuffix(invocation.Text("output"), Plain(invocation.params["name"]));
  if (invocation.Has("run")) {
    if (to_stdout)
      throw CliError(kUsage, "-o - is for pictures of the daemon", "regrasp plot NAME RUN -o FILE");
    return PlotRuns(context, invocation);
  }
  std::error_code ignored;
  const std::string other = "regrasp plot " + Plain(invocation.params["name"]) + " -o OTHER_FILE";
  fs::path target = invocation.Text("output");
  const bool into = fs::is_directory(target, ignored);
  if (invocation.Has("output") && !to_stdout) CheckTarget(into ? target / "it" : target, other);
  Invocation request = invocation;
  if (!suffix.empty()) {
    request.params["file"] = Plain(invocation.params["name"]) + suffix;
    request.params["overwrite"] = true;  // only on the way to where the user named it
  }
  Json answer = context.Call(request);
  std::string file = Plain(At(answer, "path"));
  if (to_stdout) {
    context.out().Add(Bytes(file));
    return kOk;
  }
  if (invocation.Has("output")) {
    if (into) target /= Plain(At(answer, "file"));
    Copy(file, target, other);
    file = target;
    answer["path"] = fs::absolute(target).string();
    answer["file"] = target.filename().string();
  }
  // Drawn before anything is printed: an error leaves standard output empty.
  const std::string picture = invocation.Has("show") ? DrawPicture(context, file) : "";
  context.Print(answer, [&] { context.out().Line(file); });
  context.out().Add(picture);
  return kOk;
}

}  // namespace

std::vector<CommandSpec> ResultCommands() {
  std::vector<CommandSpec> commands = {MethodCommand(
      "plot", "Results", Plot,
      {.positional = {"name"},
       .hidden = {"file", "font_size_pt"},
       .extra = {
           {.key = "run",
            .flags = "",
            .metavar = "RUN",
            .help = "a run file instead of what the daemon remembers: its last job; for comparison "
                    "several",
            .repeated = true},
           {.key = "font-size",
            .flags = "--font-size",
            .metavar = "PT",
            .help = "with --size: no text on paper is smaller",
            .default_text = "7"},
           {.key = "output",
            .flags = "-o,--output",
            .metavar = "FILE",
            .help =
                "copy the picture there; the suffix decides: .png, .jpg, .pdf, .svg; - : write it "
                "to standard output",
            .default_text = "leave it in the daemon's output directory, print its path"},
           {.key = "show",
            .flags = "--show",
            .metavar = "",
            .kind = ArgKind::kFlag,
            .help = "draw it here: kitty or sixel graphics where the terminal can, else blocks; "
                    "$REGRASP_GRAPHICS: kitty, sixel, blocks, dots"}}})};
  for (auto* group : {RunFileCommands, CheckpointCommands})
    for (CommandSpec& command : group()) commands.push_back(std::move(command));
  return commands;
}

}  // namespace regrasp::cli
