#include <cstdio>
#include <string_view>

#include "cli/commands/execute.h"
#include "cli/grammar/complete.h"
#include "core/files/draft.h"
#include "core/protocol/standard_files.h"

int main(int argc, char** argv) {
  using namespace regrasp::cli;
  regrasp::OccupyStandardFiles();
  regrasp::KeepFromOthers();
  if (argc > 1 && std::string_view(argv[1]) == "__complete") {
    try {
      std::fputs(CompletionLines({argv + 2, argv + argc}).c_str(), stdout);
      return 0;
    } catch (const CliError& error) {
      PrintError(error, false, false);
      return static_cast<int>(error.code);
    }
  }
  return static_cast<int>(Execute({argv + (argc > 0 ? 1 : 0), argv + argc}));
}
