#include "cli/client/private_directory.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "cli/client/errors.h"
#include "core/protocol/user_directories.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPattern = "regrasp-private-XXXXXX";

/// Whether nobody has a lock on an open file.
bool Free(int fd) { return ::flock(fd, LOCK_EX | LOCK_NB) == 0; }

/// Removes a directory that is this user's where neither the program that made it nor its daemon
/// lives. Its lock is held until it has gone: somebody who has just made it waits for that.
void RemoveAbandoned(const fs::path& path) {
  const int directory = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (directory < 0) return;
  struct stat info {};
  bool abandoned = ::fstat(directory, &info) == 0 && info.st_uid == ::geteuid() && Free(directory);
  if (abandoned) {
    const int lock = ::openat(directory, "regrasp.sock.lock", O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    abandoned = lock < 0 ? errno == ENOENT : Free(lock);
    if (lock >= 0) ::close(lock);
  }
  std::error_code ignored;
  if (abandoned) fs::remove_all(path, ignored);
  ::close(directory);
}

/// Of Python's clients, too.
void Sweep(const fs::path& base) {
  std::error_code error;
  fs::directory_iterator entries(base, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename();
    if (name.starts_with("regrasp-private-") || name.starts_with("regrasp-python-"))
      RemoveAbandoned(entries->path());
  }
}

fs::path Base() {
  const fs::path named = DirectoryVariable("TMPDIR");
  const std::string socket = named / kPattern / "regrasp.sock";
  return named.empty() || socket.size() >= sizeof sockaddr_un{}.sun_path ? "/tmp" : named;
}

}  // namespace

PrivateDirectory::PrivateDirectory() {
  const fs::path base = Base();
  Sweep(base);
  while (lock_ < 0) {
    std::string name = base / kPattern;
    if (::mkdtemp(name.data()) == nullptr)
      throw CliError(
          kIo,
          fmt::format("cannot make a directory in {}: {}", base.string(), std::strerror(errno)),
          "TMPDIR=OTHER_DIR before the command, or df -h " + base.string());
    path_ = name;
    lock_ = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    // Somebody who sweeps may have come first.
    if (lock_ < 0 && errno == ENOENT) continue;
    if (lock_ < 0 || ::flock(lock_, LOCK_SH) != 0)
      throw CliError(kIo, fmt::format("cannot lock {}: {}", name, std::strerror(errno)));
    if (!fs::exists(path_)) ::close(std::exchange(lock_, -1));
  }
}

PrivateDirectory::~PrivateDirectory() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  ::close(lock_);
}

}  // namespace regrasp::cli
