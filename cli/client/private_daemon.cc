#include "cli/client/private_daemon.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

namespace regrasp::cli {

PrivateDaemon::PrivateDaemon(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = arguments;
  if (std::find(words.begin(), words.end(), "--output-dir") == words.end())
    words.insert(words.end(), {"--output-dir", (directory_.path() / "output").string()});
  started_ = StartDaemon(directory_.socket(), words, 60, Surroundings::kNothing);
}

PrivateDaemon::~PrivateDaemon() {
  try {
    StopDaemon(started_.socket, 5);
  } catch (...) {
    ::kill(started_.pid, SIGKILL);  // it has nothing to lose
  }
  ::waitpid(started_.pid, nullptr, 0);
  ::close(started_.input);
}

}  // namespace regrasp::cli
