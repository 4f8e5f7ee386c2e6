#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "cli/complete.h"
#include "cli/context.h"

namespace {

int Run(int argc, char** argv) {
  using namespace regrasp;
  using namespace regrasp::cli;
  const bool error_color = ::isatty(STDERR_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  const auto fail = [&](const CliError& error) {
    PrintError(error, WantsJson(argc, argv), error_color);
    return static_cast<int>(error.code);
  };
  try {
    if (argc > 1 && std::string_view(argv[1]) == "__complete") {
      std::fputs(CompletionLines({argv + 2, argv + argc}).c_str(), stdout);
      return 0;
    }
    GlobalOptions options;
    const Invocation invocation = Parse(argc, argv, &options);
    Context context(options);
    ExitCode code = kOk;
    try {
      code = invocation.command->run(context, invocation);
    } catch (CliError& error) {
      context.out().Flush();  // what was answered before the failure
      if (error.code == kUsage && error.hint.empty()) {
        error.hint = "regrasp help " + invocation.command->words;
      }
      throw;
    }
    context.out().Flush();
    return static_cast<int>(code);
  } catch (const CliError& error) {
    return fail(error);
  } catch (const std::exception& error) {
    return fail(
        CliError(kProtocol, std::string("unexpected answer: ") + error.what(), "regrasp doctor"));
  }
}

}  // namespace

int main(int argc, char** argv) { return Run(argc, argv); }
