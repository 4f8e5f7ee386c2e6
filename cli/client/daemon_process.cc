#include "cli/client/daemon_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

#include "cli/client/client.h"
#include "cli/client/errors.h"
#include "cli/client/program.h"
#include "core/files/problem_list.h"
#include "core/files/shell_word.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

bool Executable(const fs::path& path) {
  return ::access(path.c_str(), X_OK) == 0 && fs::is_regular_file(path);
}

/// The last lines of a text, at most `count`, without what it says is to be tried next.
std::string Tail(const std::string& written, std::size_t count) {
  std::istringstream file(written);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);)
    if (!line.starts_with("try: ")) lines.push_back(line);
  std::string text;
  for (std::size_t i = lines.size() > count ? lines.size() - count : 0; i < lines.size(); ++i) {
    text += (text.empty() ? "" : " | ") + lines[i];
  }
  return text;
}

/// The error that a `regraspd` wrote before it ended, without its name: a line, or a list as
/// ProblemList::Text() makes it; "" where it wrote none.
std::string DaemonError(const std::string& written) {
  constexpr std::string_view kName = "regraspd: ";
  const std::string text = "\n" + written;
  std::size_t begin = text.rfind("\n" + std::string(kName));
  if (begin == std::string::npos) return "";
  begin += 1 + kName.size();
  std::size_t end = std::min(text.find('\n', begin), text.size());
  if (std::string_view(text).substr(0, end).ends_with(" errors:"))
    for (std::size_t i = 0; i <= ProblemList::kMost && text.compare(end, 3, "\n  ") == 0; ++i)
      end = std::min(text.find('\n', end + 1), text.size());
  return text.substr(begin, end - begin);
}

/// What a `regraspd` ended with, where main.cc of it has that from the contract.
ExitCode ExitCodeOf(int code) {
  for (const ExitCode known : {kUsage, kRefused, kNotFound, kIo, kPermission})
    if (code == static_cast<int>(known)) return known;
  return kFailed;
}

/// This program's environment, without what `surroundings` keeps from the daemon.
std::vector<char*> Environment(Surroundings surroundings) {
  std::vector<char*> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const bool ours = text.starts_with("REGRASP_") || text.starts_with("LISTEN_") ||
                      text.starts_with("NOTIFY_SOCKET=") || text.starts_with("WATCHDOG_");
    if (surroundings == Surroundings::kOfUser || !ours) variables.push_back(*variable);
  }
  variables.push_back(nullptr);
  return variables;
}

/// The child's side: own session, output to the log, then the daemon. `input_fd`: its standard
/// input, or -1 for none. Never returns. Only
/// async-signal-safe calls: the program may have threads.
[[noreturn]] void Become(char* const* argv, char* const* variables, int input_fd, int log_fd) {
  ::setsid();
  if (input_fd < 0) input_fd = ::open("/dev/null", O_RDONLY);
  ::dup2(input_fd, STDIN_FILENO);
  ::dup2(log_fd, STDOUT_FILENO);
  ::dup2(log_fd, STDERR_FILENO);
  ::close_range(3, ~0U, 0);  // locks and pipes of whoever called this program
  // Before they are let through: a handler of this program would swallow what waits to end it.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) ::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execve(argv[0], argv, variables);
  ::_exit(127);
}

/// Ends a daemon that is of no use, in a second or by force; has ended when this returns.
void End(pid_t pid) {
  ::kill(pid, SIGTERM);
  for (int i = 0; i < 100; ++i) {
    if (::waitpid(pid, nullptr, WNOHANG) != 0) return;
    ::usleep(10'000);  // not WaitFor: this may be because of an interrupt
  }
  ::kill(pid, SIGKILL);
  ::waitpid(pid, nullptr, 0);
}

}  // namespace

std::string FindDaemon() {
  std::error_code ignored;
  const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path() / "regraspd";
  if (Executable(beside)) return beside;
  const char* path = std::getenv("PATH");
  const std::string places = path != nullptr ? path : "";
  for (std::size_t begin = 0; begin <= places.size();) {
    const auto end = std::min(places.find(':', begin), places.size());
    const fs::path candidate = fs::path(places.substr(begin, end - begin)) / "regraspd";
    if (Executable(candidate)) return fs::absolute(candidate);
    begin = end + 1;
  }
  throw CliError(kNotFound, fmt::format("no regraspd: neither {} nor in $PATH", beside.string()),
                 "regrasp doctor");
}

std::string AskDaemonProgram(std::vector<std::string> words, const std::string& option,
                             const std::string& next) {
  words.insert(words.begin(), FindDaemon());
  words.push_back(option);
  const Finished finished = RunProgram(words);
  if (finished.code == 0) return finished.out;
  std::string cause = DaemonError(finished.err);
  if (cause.empty()) cause = finished.err.substr(0, finished.err.find('\n'));
  throw CliError::List(ExitCodeOf(finished.code), cause, next);
}

StartedDaemon StartDaemon(const std::string& socket, const std::vector<std::string>& arguments,
                          double timeout_s, Surroundings surroundings) {
  const std::string daemon = FindDaemon();
  CheckSocketPath(socket);  // before anything is made there
  const fs::path directory = fs::absolute(socket).parent_path();
  std::error_code error;
  if (!fs::exists(directory)) {
    fs::create_directories(directory.parent_path(), error);
    if (::mkdir(directory.c_str(), 0700) != 0 && errno != EEXIST) {
      throw CliError(errno == EACCES ? kPermission : kIo,
                     fmt::format("cannot make {}: {}", directory.string(), std::strerror(errno)),
                     "regrasp -s PATH up");
    }
  }
  StartedDaemon started{0, socket, fs::path(socket).replace_extension(".log")};
  const int log_fd =
      ::open(started.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (log_fd < 0) {
    throw CliError(errno == EACCES ? kPermission : kIo,
                   fmt::format("cannot write the log {}: {}", started.log, std::strerror(errno)),
                   "regrasp -s PATH up");
  }
  std::vector<std::string> words = {daemon, "--socket", socket};
  std::array<int, 2> input = {-1, -1};
  if (surroundings == Surroundings::kNothing) {
    words.insert(words.end(), {"--config", "/dev/null", "--until-eof"});
    if (::pipe2(input.data(), O_CLOEXEC) != 0) {
      ::close(log_fd);
      throw CliError(kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
    }
  }
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::vector<char*> variables = Environment(surroundings);
  started.pid = ::fork();
  if (started.pid == 0) Become(argv.data(), variables.data(), input[0], log_fd);
  ::close(log_fd);
  if (input[0] >= 0) ::close(input[0]);
  started.input = input[1];
  if (started.pid < 0)
    throw CliError(kIo, fmt::format("cannot start {}: {}", daemon, std::strerror(errno)));

  const bool kept = surroundings == Surroundings::kOfUser;  // the log, after this daemon
  const auto deadline = Deadline(timeout_s);
  try {
    while (!Listening(socket)) {
      int status = 0;
      if (::waitpid(started.pid, &status, WNOHANG) == started.pid) {
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
        std::ifstream log(started.log);
        const std::string written{std::istreambuf_iterator<char>(log), {}};
        const std::string cause = DaemonError(written), last = Tail(written, 3);
        const ExitCode exit_code = ExitCodeOf(code);
        const std::string next =
            kept ? "regrasp help up, or cat " + ShellWord(started.log) : "regraspd --help";
        if (cause.find('\n') != std::string::npos)
          throw CliError::List(exit_code, "regraspd: " + cause, next);
        throw CliError(exit_code,
                       last.empty() ? fmt::format("regraspd ended at once ({} {})",
                                                  WIFSIGNALED(status) ? "signal" : "exit code",
                                                  WIFSIGNALED(status) ? WTERMSIG(status) : code)
                                    : last,
                       next);
      }
      if (Clock::now() > deadline) {
        throw CliError(kTimeout, fmt::format("regraspd is not ready after {:g} s", timeout_s),
                       kept ? "cat " + ShellWord(started.log) : "regrasp doctor");
      }
      WaitFor(-1, 0, Deadline(0.01));
    }
  } catch (const CliError& failure) {
    if (failure.code == kTimeout || failure.code == kInterrupted) End(started.pid);
    if (started.input >= 0) ::close(started.input);
    throw;
  }
  return started;
}

bool WaitForLock(const std::string& socket, double timeout_s) {
  const auto deadline = Deadline(timeout_s);
  const int lock = ::open((socket + ".lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (lock < 0) return true;  // none there, or not ours: starting tells
  bool free = false;
  try {
    while (true) {
      free = ::flock(lock, LOCK_SH | LOCK_NB) == 0 || errno != EWOULDBLOCK;
      if (free || Clock::now() > deadline) break;
      WaitFor(-1, 0, Deadline(0.01));
    }
  } catch (...) {
    ::close(lock);
    throw;
  }
  ::close(lock);
  return free;
}

bool StopDaemon(const std::string& socket, double timeout_s) {
  Client client(socket, timeout_s);
  const auto deadline = Deadline(timeout_s);
  const Json answer = client.Call("shutdown", Json::object());
  // The daemon is gone when its end of this connection closes and nobody listens any more.
  try {
    while (client.NextEvent(std::chrono::duration<double>(deadline - Clock::now()).count())) {
    }
  } catch (const CliError& error) {
    if (error.code != kNoDaemon) throw;
  }
  if (answer.value("activated", false)) return true;  // looking would start it again
  while (fs::exists(socket) && Listening(socket)) {
    if (Clock::now() > deadline) {
      throw CliError(kTimeout, fmt::format("{} is still there after {:g} s", socket, timeout_s),
                     "regrasp status");
    }
    WaitFor(-1, 0, Deadline(0.01));
  }
  const double left = std::chrono::duration<double>(deadline - Clock::now()).count();
  if (!WaitForLock(socket, std::max(left, 0.01)))
    throw CliError(kTimeout,
                   fmt::format("the daemon on {} is still ending after {:g} s", socket, timeout_s),
                   "regrasp --timeout 60 down");
  return false;
}

}  // namespace regrasp::cli
