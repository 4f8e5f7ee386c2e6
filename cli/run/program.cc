#include "cli/run/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "cli/client/errors.h"
#include "core/files/names.h"
#include "core/files/output_file.h"
#include "core/files/shell_word.h"
#include "core/hand/model_error.h"
#include "core/journal/journal_text.h"
#include "core/journal/provenance.h"
#include "core/mcap/without_end.h"

namespace regrasp::run {
namespace {

void TellOnce(const std::vector<std::string>& differences, Json* told) {
  for (const std::string& difference : differences) {
    if (std::find(told->begin(), told->end(), difference) != told->end()) continue;
    told->push_back(difference);
    Note(difference);
  }
}

/// `message`, `next`: as they may be shown.
int TellFailure(const Command& command, const std::string& message, const std::string& next,
                ExitCode code) {
  const auto socket = command.options.find("--socket");
  const std::string hint =
      socket == command.options.end() ? next : cli::AtSocket(next, ShownText(socket->second));
  if (command.json())
    fmt::print(stderr, "{}\n",
               Json{{"error",
                     {{"exit_code", static_cast<int>(code)}, {"message", message}, {"hint", hint}}}}
                   .dump());
  else
    fmt::print(stderr, "regrasp: {}\n  try: {}\n", message, hint);
  return static_cast<int>(code);
}

/// The command again, for another place.
std::string WithOtherFile(const Command& command) {
  const auto option = [&](const char* name) {
    const auto found = command.options.find(name);
    return found == command.options.end() ? "" : found->second + " ";
  };
  std::string words =
      "regrasp " + command.verb + " " + option("--name") + ShellWord(command.file) + " ";
  if (command.Has("--format")) words += "--format " + option("--format");
  return words + "-o OTHER_FILE";
}

}  // namespace

double Command::Number(const char* name, double otherwise) const {
  const auto found = options.find(name);
  return found == options.end() ? otherwise : std::strtod(found->second.c_str(), nullptr);
}

void Print(const Command& command, const Json& result, const std::string& text) {
  if (!command.Has("--quiet")) fmt::print("{}\n", command.json() ? result.dump() : text);
  if (std::fflush(stdout) != 0)
    throw std::runtime_error(std::string("cannot write to standard output: ") +
                             std::strerror(errno));
}

void Note(const std::string& text) { fmt::print(stderr, "regrasp: note: {}\n", text); }

Json TellDifferences(const RunFile& file) {
  Json told = Json::array();
  for (const Segment& segment : file.segments)
    TellOnce(Differences(segment.journal->config, segment.build, ModelSearchPath("")), &told);
  return told;
}

void TellDifferences(std::string_view config, Json* told) {
  try {
    const ConfigRead run = ParseConfig(config);
    TellOnce(Differences(run.config, run.build, ModelSearchPath("")), told);
  } catch (const JournalError& e) {
    TellOnce({fmt::format("the configuration of the run cannot be used here: {}", e.what())}, told);
  }
}

Json LossesJson(const std::vector<McapLoss>& lost) {
  Json list = Json::array();
  for (const McapLoss& loss : lost)
    list.push_back(
        {{"offset", loss.offset},
         {"bytes", loss.bytes},
         {"start_s", loss.end != 0 ? Json(static_cast<double>(loss.start) * 1e-9) : Json()},
         {"end_s", loss.end != 0 ? Json(static_cast<double>(loss.end) * 1e-9) : Json()},
         {"cause", loss.cause}});
  return list;
}

std::string EndText(bool complete) { return complete ? "" : "\n  " + WithoutEndText("the file"); }

std::string LossesText(const std::vector<McapLoss>& lost) {
  std::string text;
  for (const McapLoss& loss : lost) text += "\n  lost: " + LossText(loss);
  return text;
}

int RunVerb(int argc, char** argv,
            const std::map<std::string, ExitCode (*)(const Command&)>& verbs) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error, not the end
  Command command;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--json" || argument == "--quiet")
      command.options[argument] = "";
    else if (argument.starts_with("--") && i + 1 < argc)
      command.options[argument] = argv[++i];
    else if (command.verb.empty())
      command.verb = argument;
    else
      command.files.push_back(argument);
  }
  if (!command.files.empty()) command.file = command.files.front();
  try {
    const auto verb = verbs.find(command.verb);
    if (verb != verbs.end()) return static_cast<int>(verb->second(command));
    fmt::print(stderr, "{}: unknown verb '{}'\n  try: regrasp help replay\n", argv[0],
               command.verb);
    return static_cast<int>(ExitCode::kUsage);
  } catch (const cli::CliError& e) {
    return TellFailure(command, ShownText(e.what()),
                       e.hint.empty() ? "regrasp help " + command.verb : ShownText(e.hint), e.code);
  } catch (const WriteError& e) {
    return TellFailure(command, ShownText(e.what()), ShownText(WithOtherFile(command)),
                       ExitCode::kIo);
  } catch (const ModelError& e) {
    return TellFailure(command, e.what(), "regrasp record list", ExitCode::kIo);
  } catch (const std::exception& e) {
    return TellFailure(command, ShownText(e.what()), "regrasp record list", ExitCode::kIo);
  }
}

}  // namespace regrasp::run
