// Results: pictures.

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "cli/context.h"

extern char** environ;

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

void Show(const std::string& file) {
  std::string program = "xdg-open", path = file;
  char* argv[] = {program.data(), path.data(), nullptr};
  pid_t pid = 0;
  int status = 0;
  const int error = ::posix_spawnp(&pid, "xdg-open", nullptr, nullptr, argv, environ);
  if (error != 0 || ::waitpid(pid, &status, 0) != pid || status != 0) {
    throw CliError(kFailed,
                   fmt::format("cannot show {}: xdg-open {}", file,
                               error != 0 ? std::strerror(error) : "failed"),
                   "open it with a viewer of yours");
  }
}

ExitCode Plot(Context& context, const Invocation& invocation) {
  Json answer = context.Call(invocation);
  std::string file = Plain(At(answer, "path"));
  if (invocation.Has("output")) {
    fs::path target = invocation.Text("output");
    if (fs::is_directory(target)) target /= Plain(At(answer, "file"));
    std::error_code error;
    fs::copy_file(file, target, fs::copy_options::overwrite_existing, error);
    if (error) {
      throw CliError(
          kIo, fmt::format("cannot copy {} to {}: {}", file, target.string(), error.message()),
          "regrasp plot " + Plain(invocation.params["name"]) + " -o OTHER_FILE");
    }
    file = target;
    answer["path"] = fs::absolute(target).string();
    answer["file"] = target.filename().string();
  }
  context.Print(answer, [&] { context.out().Line(file); });
  context.out().Flush();
  if (invocation.Has("show")) Show(file);
  return kOk;
}

}  // namespace

std::vector<CommandSpec> ResultCommands() {
  return {MethodCommand(
      "plot", "Results", Plot,
      {.positional = {"name"},
       .hidden = {"file"},
       .extra = {{.key = "output",
                  .flags = "-o,--output",
                  .metavar = "FILE",
                  .help = "copy the picture there",
                  .default_text = "leave it in the daemon's output directory, print its path"},
                 {.key = "show",
                  .flags = "--show",
                  .metavar = "",
                  .kind = ArgKind::kFlag,
                  .help = "open it in a viewer"}}})};
}

}  // namespace regrasp::cli
