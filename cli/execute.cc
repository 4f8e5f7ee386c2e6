#include "cli/execute.h"

#include <unistd.h>

#include "cli/context.h"

namespace regrasp::cli {

ExitCode Execute(const std::vector<std::string>& words, const GlobalOptions& defaults,
                 const std::string& where) {
  GlobalOptions options = defaults;
  std::vector<const char*> argv = {"regrasp"};
  for (const auto& word : words) argv.push_back(word.c_str());
  const int argc = static_cast<int>(argv.size());
  const auto fail = [&](const CliError& error) {
    const CliError placed(error.code, where + error.what(), error.hint, error.rpc_code);
    PrintError(placed, defaults.json || WantsJson(argc, argv.data()),
               WantsColor(options.color, STDERR_FILENO));
    return error.code;
  };
  try {
    const Invocation invocation = Parse(argc, argv.data(), &options);
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
    return code;
  } catch (const CliError& error) {
    return fail(error);
  } catch (const std::exception& error) {
    return fail(
        CliError(kProtocol, std::string("unexpected answer: ") + error.what(), "regrasp doctor"));
  }
}

}  // namespace regrasp::cli
