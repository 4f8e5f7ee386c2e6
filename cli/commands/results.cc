// Results: pictures.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "cli/client/context.h"
#include "cli/commands/run_files.h"
#include "cli/print/terminal_graphics.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

/// Copies a picture; one that is there already, under whatever name, is left as it is. Throws
/// CliError(kIo) with `next` to try.
void CopyTo(const fs::path& target, const std::string& file, const std::string& next) {
  std::error_code error, ignored;
  if (fs::equivalent(file, target, ignored)) return;
  fs::copy_file(file, target, fs::copy_options::overwrite_existing, error);
  if (error)
    throw CliError(
        kIo, fmt::format("cannot copy {} to {}: {}", file, target.string(), error.message()), next);
}

std::string Bytes(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw CliError(kIo, "cannot read " + file, "ls -l " + file);
  return {std::istreambuf_iterator<char>(in), {}};
}

ExitCode Plot(Context& context, const Invocation& invocation) {
  if (invocation.Has("show") && !context.out().human()) {
    throw CliError(kUsage, "--show draws for people: it goes with neither --json nor --csv",
                   "regrasp plot " + Plain(invocation.params["name"]) + " --show");
  }
  const bool to_stdout = invocation.Text("output") == "-";
  if (to_stdout && (invocation.Has("show") || !context.out().human()))
    throw CliError(kUsage,
                   "-o - writes the picture itself: it goes with none of --show, --json, --csv",
                   "regrasp plot " + Plain(invocation.params["name"]) + " -o - > FILE.png");
  Invocation request = invocation;
  if (const std::string suffix = fs::path(invocation.Text("output")).extension(); !suffix.empty())
    request.params["file"] = Plain(invocation.params["name"]) + suffix;
  Json answer = context.Call(request);
  std::string file = Plain(At(answer, "path"));
  if (to_stdout) {
    context.out().Add(Bytes(file));
    return kOk;
  }
  if (invocation.Has("output")) {
    fs::path target = invocation.Text("output");
    if (fs::is_directory(target)) target /= Plain(At(answer, "file"));
    CopyTo(target, file, "regrasp plot " + Plain(invocation.params["name"]) + " -o OTHER_FILE");
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
       .hidden = {"file"},
       .extra = {
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
