// Results: pictures.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "cli/client/context.h"
#include "cli/commands/run_files.h"
#include "cli/print/terminal_graphics.h"
#include "core/files/draft.h"
#include "core/files/read_file.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

/// The user named the target: what is there is replaced, at once and whole.
void Copy(const fs::path& picture, const fs::path& target, const std::string& next) {
  constexpr std::uint64_t kMaxPicture = 256u << 20;  // [bytes]
  std::error_code ignored;
  if (fs::equivalent(picture, target, ignored)) return;
  try {
    const fs::path directory = fs::absolute(target).parent_path();
    if (!fs::is_directory(directory))
      throw std::runtime_error(directory.string() + " is not a directory");
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
  if (const std::string suffix = fs::path(invocation.Text("output")).extension(); !suffix.empty()) {
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
    fs::path target = invocation.Text("output");
    if (fs::is_directory(target)) target /= Plain(At(answer, "file"));
    Copy(file, target, "regrasp plot " + Plain(invocation.params["name"]) + " -o OTHER_FILE");
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
