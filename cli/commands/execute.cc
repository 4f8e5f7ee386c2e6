#include "cli/commands/execute.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "cli/client/context.h"
#include "core/files/names.h"

namespace regrasp::cli {
namespace {

/// The daemon's refusals are for any client: where its hint is no command, it belongs to the cause,
/// and the next command is found here.
CliError ForPeople(const CliError& error, const std::string& words) {
  if (error.rpc_code == 0 || error.hint.starts_with("regrasp")) return error;
  const std::string next = words.starts_with("job ")     ? "regrasp job list"
                           : words.starts_with("param ") ? "regrasp param list"
                                                         : "regrasp help " + words;
  const std::string cause = error.what();
  return error.With(error.is_list ? cause : WithHint(cause, error.hint), next);
}

bool DirectoryHasGone() {
  std::error_code error;
  static_cast<void>(std::filesystem::current_path(error));
  return error == std::errc::no_such_file_or_directory;
}

/// Before something is begun whose answer nobody could get. What only can be met while writing, a
/// full disk say, is told then.
void CheckOutputOpen() {
  const int flags = ::fcntl(STDOUT_FILENO, F_GETFL);
  if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) FailToPrint(EBADF);
}

}  // namespace

ExitCode Execute(const std::vector<std::string>& words, const GlobalOptions& defaults,
                 const std::string& where) {
  GlobalOptions options = defaults;
  std::vector<const char*> argv = {"regrasp"};
  for (const auto& word : words) argv.push_back(word.c_str());
  const int argc = static_cast<int>(argv.size());
  const auto fail = [&](const CliError& error) {
    PrintError(error.With(where + error.what(), AtSocket(error.hint, options.socket)),
               defaults.json || WantsJson(argc, argv.data()),
               WantsColor(options.color, STDERR_FILENO));
    return error.code;
  };
  try {
    for (std::size_t i = 0; i < words.size(); ++i)
      if (!IsUtf8(words[i]))
        throw CliError(kUsage, fmt::format("argument {} is not UTF-8: {}", i + 1, Shown(words[i])),
                       "regrasp help");
    const Invocation invocation = Parse(argc, argv.data(), &options);
    if (!options.quiet) CheckOutputOpen();
    Context context(options);
    ExitCode code = kOk;
    try {
      code = invocation.command->run(context, invocation);
    } catch (CliError& error) {
      context.out().Flush();  // what was answered before the failure
      if (error.code == kUsage && error.hint.empty() && error.rpc_code == 0) {
        error.hint = "regrasp help " + invocation.command->words;
      }
      const std::string gone = "the current directory has gone", cause = error.what();
      if (error.code == kIo && cause.find(gone) == std::string::npos && DirectoryHasGone())
        throw error.With(cause + "; " + gone, "cd, then the same again");
      throw ForPeople(error, invocation.command->words);
    }
    context.out().Flush();
    return code;
  } catch (const CliError& error) {
    return fail(error);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(DirectoryHasGone()
                    ? CliError(kIo, "the current directory has gone", "cd, then the same again")
                    : CliError(kIo, error.what(), "regrasp doctor"));
  } catch (const std::exception& error) {
    return fail(
        CliError(kProtocol, std::string("unexpected answer: ") + error.what(), "regrasp doctor"));
  }
}

}  // namespace regrasp::cli
