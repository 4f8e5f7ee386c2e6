#include "core/files/output_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

namespace regrasp {
namespace {

namespace fs = std::filesystem;

/// `path`, or of what is above it the first that is there.
fs::path ThereOf(fs::path path) {
  std::error_code error;
  while (!fs::exists(path, error) && path.has_relative_path()) path = path.parent_path();
  return path;
}

/// Runs what may throw a draft's own errors, which name the target.
template <typename Function>
void AsWriteError(const Function& function) {
  try {
    function();
  } catch (const std::runtime_error& error) {
    throw WriteError(error.what());
  }
}

}  // namespace

void CheckWritable(const std::string& target, Draft::Existing existing) {
  if (target.empty()) throw WriteError("a file without a name cannot be written");
  struct stat info {};
  if (existing == Draft::Existing::kKeep && ::lstat(target.c_str(), &info) == 0)
    throw WriteError(target + " exists; give another name");
  std::error_code error;
  const fs::path directory = fs::absolute(target, error).parent_path();
  const bool made = existing == Draft::Existing::kKeep;  // where it is missing
  const std::string cause = error || made || fs::is_directory(directory, error)
                                ? WhyNoOutput(fs::path(target).parent_path())
                                : directory.string() + " is not a directory";
  if (!cause.empty()) throw WriteError("cannot write " + target + ": " + cause);
}

std::string WhyNoOutput(const std::string& directory) {
  std::error_code error;
  const fs::path there = ThereOf(fs::absolute(fs::path(directory) / "it", error).parent_path());
  if (error) return "the current directory has gone";
  if (!fs::is_directory(there, error)) return there.string() + " is not a directory";
  std::string probe = (there / ".regrasp-XXXXXX").string();
  if (::mkdtemp(probe.data()) != nullptr) {
    ::rmdir(probe.c_str());
    return "";
  }
  if (errno == ENOSPC || errno == EDQUOT) return "";
  return there.string() + ": " + std::strerror(errno);
}

void WriteOutput(const std::string& target, Draft::Existing existing,
                 const std::function<void(const std::string& draft)>& write, Draft::Kind kind) {
  std::optional<Draft> draft;
  AsWriteError([&] { draft.emplace(target, existing, kind); });
  try {
    write(draft->path());
  } catch (const std::runtime_error& e) {
    // The writer knows the draft's name; who reads this, the file's.
    std::string cause = e.what();
    const auto at = cause.find(draft->path());
    if (at == std::string::npos) throw;
    throw WriteError(cause.replace(at, draft->path().size(), target));
  }
  AsWriteError([&] { draft->Commit(); });
}

}  // namespace regrasp
