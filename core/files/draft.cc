#include "core/files/draft.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "core/common/fnv1a.h"

namespace regrasp {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Fail(const char* what, const std::string& path, const std::string& cause) {
  throw std::runtime_error(std::string("cannot ") + what + " " + path + ": " + cause);
}
[[noreturn]] void Fail(const char* what, const std::string& path) {
  Fail(what, path, std::strerror(errno));
}
[[noreturn]] void Exists(const std::string& path) {
  throw std::runtime_error(path + " exists; give another name");
}

bool IsThere(const std::string& path) {
  struct stat info {};
  return ::lstat(path.c_str(), &info) == 0;
}

/// Where a process number means what it means here: this boot of this machine, this namespace.
const std::string& PidSpace() {
  static const std::string space = [] {
    std::string text;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> text;
    std::error_code ignored;
    text += fs::read_symlink("/proc/self/ns/pid", ignored).string();
    return std::to_string(Fnv1a(text));
  }();
  return space;
}

void Sync(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) Fail("open", path);
  const int failed = ::fsync(fd) != 0 ? errno : 0;
  ::close(fd);
  // Some file systems cannot, and say so.
  if (failed != 0 && failed != EINVAL && failed != ENOTSUP)
    Fail("write", path, std::strerror(failed));
}

/// Whether whoever made the draft `path` may still be at it. `name`: what follows ".draft-".
bool MakerMayWrite(const std::string& name, const fs::path& path) {
  const std::size_t end = name.find('-');
  const pid_t maker = std::atoi(name.c_str());
  if (end != std::string::npos &&
      name.compare(end + 1, PidSpace().size() + 1, PidSpace() + "-") == 0)
    return maker > 0 && maker != ::getpid() && (::kill(maker, 0) == 0 || errno == EPERM);
  // In a container or on another machine: who writes does so now and then.
  std::error_code error;
  const auto written = fs::last_write_time(path, error);
  return !error && fs::file_time_type::clock::now() - written < std::chrono::hours(24);
}

void SyncTree(const std::string& path) {
  if (fs::is_directory(path))
    for (const auto& entry : fs::recursive_directory_iterator(path)) Sync(entry.path());
  Sync(path);
}

}  // namespace

Draft::Draft(std::string target, Existing existing, Kind kind)
    : target_(std::move(target)), existing_(existing) {
  while (target_.size() > 1 && target_.back() == '/') target_.pop_back();
  if (target_.empty()) throw std::runtime_error("a file without a name cannot be made");
  if (existing_ == Existing::kKeep && IsThere(target_)) Exists(target_);
  const fs::path whole(target_), parent = whole.parent_path();
  if (!parent.empty()) {
    std::error_code error;
    fs::create_directories(parent, error);
    if (error) Fail("make the directory", parent, error.message());
  }
  static std::atomic<unsigned> number{0};
  for (int attempt = 0;; ++attempt) {
    path_ = parent / (".draft-" + std::to_string(::getpid()) + "-" + PidSpace() + "-" +
                      std::to_string(++number) + whole.extension().string());
    if (kind == Kind::kDirectory) {
      if (::mkdir(path_.c_str(), 0777) == 0) break;
      if (errno != EEXIST || attempt == 100) Fail("make the directory", path_);
    } else if (!IsThere(path_)) {
      break;
    }
  }
}

Draft::~Draft() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(path_, ignored);
}

void Draft::Commit(bool durable) {
  if (durable) SyncTree(path_);
  const unsigned flags = existing_ == Existing::kKeep ? RENAME_NOREPLACE : 0;
  int result = ::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), flags);
  if (result != 0 && errno == EINVAL && flags != 0) {  // a file system that cannot tell
    if (IsThere(target_)) Exists(target_);
    result = ::rename(path_.c_str(), target_.c_str());
  }
  if (result != 0 && errno == EEXIST) Exists(target_);
  if (result != 0) Fail("write", target_);
  committed_ = true;
  const std::string parent = fs::path(target_).parent_path();
  if (durable) Sync(parent.empty() ? "." : parent);
}

void WriteWhole(const std::string& target, std::string_view text, Draft::Existing existing,
                bool durable) {
  Draft draft(target, existing);
  const int fd = ::open(draft.path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) Fail("create", target);
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int cause = errno;
      ::close(fd);
      Fail("write", target, std::strerror(cause));
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::close(fd) != 0) Fail("write", target);
  draft.Commit(durable);
}

void KeepFromOthers() { ::umask(::umask(0) | S_IWGRP | S_IWOTH); }

void RemoveAbandonedDrafts(const std::string& directory) {
  std::error_code error;
  fs::directory_iterator entries(directory.empty() ? "." : directory, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    constexpr std::string_view kBegin = ".draft-";
    if (!name.starts_with(kBegin)) continue;
    if (!MakerMayWrite(name.substr(kBegin.size()), entries->path()))
      fs::remove_all(entries->path(), error);
    error.clear();
  }
}

}  // namespace regrasp
