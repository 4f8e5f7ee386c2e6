// regrasp-hand: looks at a hand's files and makes scenarios. `regrasp hand` checks the arguments
// and executes it.

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "cli/hand/hand_command.h"
#include "core/common/limit_text.h"
#include "core/files/json_text.h"
#include "core/files/names.h"

namespace regrasp::hand {

double Options::Number(const std::string& flag, double otherwise, double min, double max) const {
  if (!Has(flag)) return otherwise;
  const std::string& text = values.at(flag);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(value >= min && value <= max))
    throw Failure(ExitCode::kUsage,
                  fmt::format("{} {}: expected a number from {} to {}", flag, Shown(text),
                              LeastText(min), MostText(max)),
                  "regrasp help hand " + verb);
  return value;
}

namespace {

void TellFailure(const Options& options, const std::string& cause, const std::string& next,
                 const std::vector<std::string>& errors = {}) {
  if (!options.Has("--json")) return fmt::print(stderr, "regrasp: {}\n  try: {}\n", cause, next);
  Json error = {{"message", cause}, {"hint", next}};
  if (errors.size() > 1) error["errors"] = errors;
  fmt::print(stderr, "{}\n", JsonText(Json{{"error", error}}));
}

/// What may help against what a file is refused for: the flags that the refusal names.
std::string NextFor(const ModelError& error) {
  const std::string cause = error.what();
  if (cause.find("$REGRASP_MODELS_DIR is") != std::string::npos) return "unset REGRASP_MODELS_DIR";
  if (error.names_no_model) return "give the path of a .urdf or .toml file";
  std::string flags;
  for (const char* flag : {" --fill-missing-meshes", " --inertia-from-shape"})
    if (cause.find(flag) != std::string::npos) flags += flag;
  return flags.empty() ? "mend the file, then check again"
                       : fmt::format("mend the file, or the same with{}", flags);
}

int Main(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool flag = argument == "--json" || argument == "--quiet" || argument == "--force" ||
                      argument == "--inertia-from-shape" || argument == "--fill-missing-meshes";
    if (flag)
      options.values[argument] = "";
    else if (argument.starts_with("--") && i + 1 < argc)
      options.values[argument] = argv[++i];
    else
      (options.verb.empty() ? options.verb : options.file) = argument;
  }
  try {
    Answer answer;
    if (options.verb == "check")
      answer = CheckHand(options);
    else if (options.verb == "new")
      answer = NewHand(options);
    else
      throw Failure(ExitCode::kUsage, fmt::format("regrasp-hand: unknown verb '{}'", options.verb),
                    "regrasp help hand check");
    if (!options.Has("--quiet"))
      fmt::print("{}\n", options.Has("--json") ? JsonText(answer.json) : answer.text);
    if (std::fflush(stdout) != 0)
      throw Failure(ExitCode::kIo,
                    std::string("cannot write to standard output: ") + std::strerror(errno),
                    "regrasp doctor");
    return static_cast<int>(answer.code);
  } catch (const Failure& failure) {
    TellFailure(options, ShownText(failure.what()), failure.next);
    return static_cast<int>(failure.code);
  } catch (const ModelError& error) {
    TellFailure(options, error.what(), NextFor(error), error.problems.Messages());
    return static_cast<int>(error.names_no_model ? ExitCode::kNotFound : ExitCode::kFailed);
  } catch (const std::exception& error) {
    TellFailure(options, ShownText(error.what()), "regrasp help hand " + options.verb);
    return static_cast<int>(ExitCode::kIo);
  }
}

}  // namespace
}  // namespace regrasp::hand

int main(int argc, char** argv) { return regrasp::hand::Main(argc, argv); }
