#include "core/protocol/socket_path.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>

#include "core/protocol/user_directories.h"

namespace regrasp {
namespace {

constexpr const char* kTail = "/regrasp/regrasp.sock";

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool IsSocket(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && S_ISSOCK(info.st_mode);
}

bool IsDirectory(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode);
}

bool CanHost(const std::string& socket) {
  const std::filesystem::path directory = std::filesystem::path(socket).parent_path();
  const std::string where =
      IsDirectory(directory.string()) ? directory.string() : directory.parent_path().string();
  return IsDirectory(where) && ::access(where.c_str(), W_OK | X_OK) == 0;
}

}  // namespace

SocketPath ResolveSocketPath(const std::string& flag, const std::string& config, SocketUse use) {
  if (!flag.empty()) return {flag, "flag"};
  if (const std::string value = Environment("REGRASP_SOCKET"); !value.empty())
    return {value, "$REGRASP_SOCKET"};
  if (!config.empty()) return {config, "config"};

  const std::string runtime = DirectoryVariable("XDG_RUNTIME_DIR");
  const std::array<SocketPath, 3> candidates = {
      SocketPath{runtime.empty() ? "" : runtime + kTail, "$XDG_RUNTIME_DIR"},
      SocketPath{std::string("/run") + kTail, "/run"},
      SocketPath{"/tmp/regrasp-" + std::to_string(::geteuid()) + "/regrasp.sock", "/tmp"}};
  if (use == SocketUse::kConnect)
    for (const SocketPath& candidate : candidates)
      if (!candidate.path.empty() && IsSocket(candidate.path)) return candidate;
  for (const SocketPath& candidate : candidates)
    if (!candidate.path.empty() && CanHost(candidate.path)) return candidate;
  return candidates.back();
}

std::string DistrustedDirectory(const std::string& path) {
  std::string directory = std::filesystem::path(path).parent_path().string();
  if (directory.empty()) directory = ".";
  struct stat info {};
  if (::stat(directory.c_str(), &info) != 0) return {};
  if (info.st_uid != ::geteuid() && info.st_uid != 0)
    return directory + " belongs to user " + std::to_string(info.st_uid);
  if ((info.st_mode & (S_IWGRP | S_IWOTH)) != 0 && (info.st_mode & S_ISVTX) == 0)
    return directory + " can be written by others";
  return {};
}

}  // namespace regrasp
