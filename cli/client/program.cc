#include "cli/client/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>
#include <utility>

#include "cli/client/errors.h"
#include "cli/client/wait.h"
#include "core/files/draft.h"

namespace regrasp::cli {
namespace {

/// Reads both pipes to their ends. Throws CliError(kInterrupted).
void Collect(std::array<pollfd, 2> ends, std::array<std::string*, 2> texts) {
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    WaitForAny(ends, Deadline(0));
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      char chunk[65536];
      const ssize_t n = ::read(ends[i].fd, chunk, sizeof chunk);
      if (n > 0)
        texts[i]->append(chunk, static_cast<std::size_t>(n));
      else if (n == 0 || errno != EINTR)
        ends[i].fd = -1;  // poll ignores it
    }
  }
}

/// The child's side. It ends with `parent`, also where that has gone already. Only
/// async-signal-safe calls: the program may have threads. Returns where it cannot be run.
void Become(char* const* argv, pid_t parent, const Pipes& pipes) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);
  if (pipes.out >= 0) {
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(pipes.out, STDOUT_FILENO);
    ::dup2(pipes.err, STDERR_FILENO);
  }
  // Before they are let through: a handler of this program would swallow what waits to end it.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    struct sigaction action;
    if (::sigaction(number, nullptr, &action) == 0 && action.sa_handler != SIG_IGN)
      ::signal(number, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execvp(argv[0], argv);
}

/// Ends a program that was interrupted, in ten seconds or by force; has ended when this returns.
void End(pid_t pid) {
  ::kill(pid, SIGTERM);
  for (int i = 0; i < 1000; ++i) {
    if (::waitpid(pid, nullptr, WNOHANG) != 0) return;
    ::usleep(10'000);  // not WaitFor: the interrupt would end it
  }
  ::kill(pid, SIGKILL);
  ::waitpid(pid, nullptr, 0);
}

}  // namespace

std::string FindHelper(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path bin = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& path : {bin / name, bin / REGRASP_LIBEXEC_FROM_BIN / name})
    if (::access(path.c_str(), X_OK) == 0) return path;
  throw CliError(kNotFound, fmt::format("no {} beside {}", name, (bin / "regrasp").string()),
                 "regrasp doctor");
}

pid_t Start(const std::vector<std::string>& words, const Pipes& pipes) {
  std::vector<std::string> copy = words;
  std::vector<char*> argv;
  for (auto& word : copy) argv.push_back(word.data());
  argv.push_back(nullptr);
  int told[2];  // why it cannot be run; closed when it runs
  if (::pipe2(told, O_CLOEXEC) != 0)
    throw CliError(kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  const pid_t parent = ::getpid(), pid = ::fork();
  if (pid == 0) {
    Become(argv.data(), parent, pipes);
    const int failure = errno;
    ::_exit(::write(told[1], &failure, sizeof failure) == sizeof failure ? 127 : 126);
  }
  int failure = pid < 0 ? errno : 0;
  ::close(told[1]);
  while (pid > 0 && ::read(told[0], &failure, sizeof failure) < 0 && errno == EINTR) {
  }
  ::close(told[0]);
  if (failure == 0) return pid;
  if (pid > 0) ::waitpid(pid, nullptr, 0);
  throw CliError(kNotFound, fmt::format("cannot run {}: {}", words[0], std::strerror(failure)),
                 "regrasp doctor");
}

int WaitForEnd(pid_t pid) {
  const Interruptible interruptible;
  int status = 0;
  try {
    const auto ended = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
    if (ended < 0) throw CliError(kIo, fmt::format("waiting failed: {}", std::strerror(errno)));
    try {
      WaitFor(ended, POLLIN, Deadline(0));
    } catch (const CliError&) {
      ::close(ended);
      throw;
    }
    ::close(ended);
  } catch (const CliError&) {
    End(pid);
    throw;
  }
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  const int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  if (code == static_cast<int>(kInterrupted)) throw CliError(kInterrupted, "interrupted");
  return code;
}

ExitCode RunHelper(const std::vector<std::string>& words, const std::string& output) {
  const Interruptible interruptible;
  int code = 0;
  try {
    code = WaitForEnd(Start(words));
  } catch (const CliError& error) {
    if (error.code == kInterrupted && !output.empty())
      RemoveAbandonedDrafts(std::filesystem::path(output).parent_path());
    throw;
  }
  if (code <= 128) return static_cast<ExitCode>(code);
  const std::string name = std::filesystem::path(words[0]).filename();
  throw CliError(kFailed, fmt::format("{} ended by signal {}", name, code - 128), "regrasp doctor");
}

Finished RunProgram(const std::vector<std::string>& words) {
  const Interruptible interruptible;
  int out[2], err[2];
  if (::pipe2(out, O_CLOEXEC) != 0)
    throw CliError(kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  if (::pipe2(err, O_CLOEXEC) != 0) {
    ::close(out[0]);
    ::close(out[1]);
    throw CliError(kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  Finished finished;
  pid_t pid = 0;
  std::exception_ptr failure;
  try {
    pid = Start(words, {out[1], err[1]});
    ::close(std::exchange(out[1], -1));
    ::close(std::exchange(err[1], -1));
    Collect({pollfd{out[0], POLLIN, 0}, pollfd{err[0], POLLIN, 0}}, {&finished.out, &finished.err});
  } catch (const CliError&) {
    failure = std::current_exception();
  }
  for (const int fd : {out[0], out[1], err[0], err[1]})
    if (fd >= 0) ::close(fd);
  if (failure && pid > 0) End(pid);
  if (failure) std::rethrow_exception(failure);
  finished.code = WaitForEnd(pid);
  return finished;
}

}  // namespace regrasp::cli
