#include "cli/client/private_daemon.h"

#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "cli/client/errors.h"

namespace regrasp::cli {

PrivateDaemon::PrivateDaemon(const std::vector<std::string>& arguments) {
  char name[] = "/tmp/regrasp-private-XXXXXX";
  if (::mkdtemp(name) == nullptr) throw CliError(kIo, "cannot make a directory in /tmp", "df /tmp");
  directory_ = name;
  std::vector<std::string> words = arguments;
  if (std::find(words.begin(), words.end(), "--output-dir") == words.end())
    words.insert(words.end(), {"--output-dir", (directory_ / "output").string()});
  try {
    started_ = StartDaemon(directory_ / "regrasp.sock", words, 60, Surroundings::kNothing);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
    throw;
  }
}

PrivateDaemon::~PrivateDaemon() {
  try {
    StopDaemon(started_.socket, 5);
  } catch (...) {
    ::kill(started_.pid, SIGKILL);  // it has nothing to lose
  }
  ::waitpid(started_.pid, nullptr, 0);
  ::close(started_.input);
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

}  // namespace regrasp::cli
