#include "cli/client/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>

#include "cli/client/errors.h"

extern char** environ;

namespace regrasp::cli {
namespace {

/// Reads both pipes to their ends.
void Collect(std::array<pollfd, 2> ends, std::array<std::string*, 2> texts) {
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    if (::poll(ends.data(), ends.size(), -1) < 0 && errno != EINTR) return;
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

pid_t Start(const std::vector<std::string>& words, const posix_spawn_file_actions_t* actions) {
  std::vector<std::string> copy = words;
  std::vector<char*> argv;
  for (auto& word : copy) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t pid = 0;
  const int failure = ::posix_spawnp(&pid, argv[0], actions, &attributes, argv.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  if (failure != 0)
    throw CliError(kNotFound, fmt::format("cannot run {}: {}", words[0], std::strerror(failure)),
                   "regrasp doctor");
  return pid;
}

int WaitForEnd(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0)
    if (errno != EINTR)
      throw CliError(kIo, fmt::format("waiting failed: {}", std::strerror(errno)), "");
  if (!WIFSIGNALED(status)) return WEXITSTATUS(status);
  if (WTERMSIG(status) == SIGINT) throw CliError(kInterrupted, "interrupted");
  return 128 + WTERMSIG(status);
}

Finished RunProgram(const std::vector<std::string>& words) {
  int out[2], err[2];
  if (::pipe2(out, O_CLOEXEC) != 0)
    throw CliError(kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  if (::pipe2(err, O_CLOEXEC) != 0) {
    ::close(out[0]);
    ::close(out[1]);
    throw CliError(kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  Finished finished;
  pid_t pid = 0;
  std::exception_ptr failure;
  try {
    pid = Start(words, &actions);
  } catch (const CliError&) {
    failure = std::current_exception();
  }
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(out[1]);
  ::close(err[1]);
  if (!failure)
    Collect({pollfd{out[0], POLLIN, 0}, pollfd{err[0], POLLIN, 0}}, {&finished.out, &finished.err});
  ::close(out[0]);
  ::close(err[0]);
  if (failure) std::rethrow_exception(failure);
  finished.code = WaitForEnd(pid);
  return finished;
}

}  // namespace regrasp::cli
