#include "cli/shell/shell.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "cli/commands/execute.h"
#include "cli/grammar/complete.h"
#include "cli/shell/editor.h"
#include "cli/shell/words.h"

namespace regrasp::cli {
namespace {

/// How long the prompt waits for a daemon that does not answer, unless --timeout says so [s].
constexpr double kPromptPatience = 1.0;

/// A line's words, without the `regrasp` that a line copied from elsewhere begins with.
std::vector<std::string> CommandWords(const std::string& line) {
  auto words = SplitWords(line);
  if (!words.empty() && words.front() == "regrasp") words.erase(words.begin());
  if (!words.empty() && words.front() == "shell")
    throw CliError(kUsage, "this is the shell already", "help");
  return words;
}

/// Files with this suffix ("": any) and folders that begin with `last`; folders end with '/'. A
/// name that begins with - would be an option.
std::vector<std::string> Files(const std::string& last, const std::string& suffix) {
  namespace fs = std::filesystem;
  const auto slash = last.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : last.substr(0, slash + 1);
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') && last.size() == folder.size()) continue;  // hidden
    const bool is_folder = entry.is_directory(error);
    if (!is_folder && !name.ends_with(suffix)) continue;
    const std::string path = folder + name + (is_folder ? "/" : "");
    if (path.starts_with(last)) names.push_back((path.starts_with('-') ? "./" : "") + path);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A signal that ends the shell came while something was waited for.
bool MustEnd() { return SignalReceived() != 0 && SignalReceived() != SIGINT; }

std::string Prompt(const GlobalOptions& options) {
  const Interruptible interruptible;
  try {
    const double patience = options.timeout_s.value_or(kPromptPatience);
    const Json status =
        Client(ClientSocket(options.socket), patience).Call("status", Json::object());
    return fmt::format("regrasp {}{}> ", Plain(At(status, "state")),
                       At(status, "paused") == true ? " (paused)" : "");
  } catch (const CliError& error) {
    if (MustEnd()) throw;
    const bool waited = error.code == kTimeout || error.code == kInterrupted;
    return waited ? "regrasp (no answer)> " : "regrasp (no daemon)> ";
  }
}

/// While it lives, Ctrl-C ends commands and drops lines, never the shell. A handler, for what is
/// ignored here would be ignored by the programs it starts too.
class KeepOnInterrupt {
 public:
  KeepOnInterrupt() {
    struct sigaction nothing = {};
    nothing.sa_handler = [](int) {};
    ::sigaction(SIGINT, &nothing, &before_);
  }
  ~KeepOnInterrupt() { ::sigaction(SIGINT, &before_, nullptr); }
  KeepOnInterrupt(const KeepOnInterrupt&) = delete;
  KeepOnInterrupt& operator=(const KeepOnInterrupt&) = delete;

 private:
  struct sigaction before_ = {};
};

ExitCode Converse(Context& context) {
  const KeepOnInterrupt keep;
  const GlobalOptions& options = context.options();
  const auto complete = [&options](const std::string& line) {
    TypedWords typed = SplitTyped(line);
    if (!typed.words.empty() && typed.words.front() == "regrasp")
      typed.words.erase(typed.words.begin());
    const Candidates found =
        Complete(typed.words, typed.last,
                 AskDaemon(options.socket, options.timeout_s.value_or(kTabPatience)));
    std::vector<std::string> words;
    if (found.files) words = Files(typed.last, found.suffix);
    for (const Candidate& candidate : found.words) words.push_back(candidate.word);
    return LineEditor::Completion{std::move(words), typed.last_begin};
  };
  if (!options.quiet && context.out().human()) {
    context.out().Line(fmt::format(
        "regrasp {}: help lists the commands, Tab completes, Ctrl-D ends", REGRASP_VERSION));
    context.out().Flush();
  }
  LineEditor editor(HistoryFile(), complete);
  while (true) {
    std::string line;
    const auto result = editor.Read(Prompt(options), &line);
    if (result == LineEditor::Result::kInterrupted) continue;
    if (result == LineEditor::Result::kEnd) {
      context.out().Line();
      return kOk;
    }
    try {
      const auto words = CommandWords(line);
      if (words.empty()) continue;
      if (words.size() == 1 && (words[0] == "exit" || words[0] == "quit")) return kOk;
      const Interruptible interruptible;
      Execute(words, options);
      if (MustEnd()) return kInterrupted;
    } catch (const CliError& error) {
      PrintError(error.With(error.what(), AtSocket(error.hint, options.socket)), options.json,
                 WantsColor(options.color, STDERR_FILENO));
    }
  }
}

/// Runs the lines of `in`, `name` for people. The exit code of the first failure, or kOk.
ExitCode RunScript(Context& context, std::istream& in, const std::string& name, bool keep_going) {
  const auto at_socket = [&](const std::string& hint) {
    return AtSocket(hint, context.options().socket);
  };
  ExitCode first = kOk;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string where = fmt::format("{}:{}: ", name, number);
    ExitCode code = kOk;
    try {
      const auto words = CommandWords(line);
      if (words.empty()) continue;
      if (words.size() == 1 && (words[0] == "exit" || words[0] == "quit")) return first;
      code = Execute(words, context.options(), where);
    } catch (const CliError& error) {
      PrintError({error.code, where + error.what(), at_socket(error.hint)}, context.options().json,
                 WantsColor(context.options().color, STDERR_FILENO));
      code = error.code;
    }
    if (code == kOk) continue;
    if (first == kOk) first = code;
    if (!keep_going || code == kInterrupted) {
      // The command has said what failed, on stdout or stderr; this is where, and that no more
      // follows.
      if (in.peek() != std::istream::traits_type::eof() && !context.options().quiet) {
        PrintError({code,
                    fmt::format("{}stopped: '{}' ended with exit code {}", where, line,
                                static_cast<int>(code)),
                    at_socket("regrasp shell --keep-going, to run the rest all the same")},
                   context.options().json, WantsColor(context.options().color, STDERR_FILENO));
      }
      return first;
    }
  }
  if (in.bad()) throw CliError(kIo, fmt::format("cannot read {}: {}", name, std::strerror(errno)));
  return first;
}

}  // namespace

ExitCode Shell(Context& context, const Invocation& invocation) {
  const bool keep_going = invocation.Has("keep_going");
  const std::string name = invocation.Text("file", "-");
  if (name == "-") {
    if (::isatty(STDIN_FILENO) == 1 && ::isatty(STDOUT_FILENO) == 1) return Converse(context);
    return RunScript(context, std::cin, "standard input", keep_going);
  }
  std::error_code error;
  if (!std::filesystem::exists(name, error))
    throw CliError(kNotFound, fmt::format("no file {}", name), "regrasp help shell");
  std::ifstream file(name);
  if (!file || std::filesystem::is_directory(name, error)) {
    const bool denied = errno == EACCES;
    throw CliError(
        denied ? kPermission : kIo,
        fmt::format("cannot read {}: {}", name, denied ? std::strerror(EACCES) : "not a file"),
        "ls -l " + name);
  }
  return RunScript(context, file, name, keep_going);
}

}  // namespace regrasp::cli
