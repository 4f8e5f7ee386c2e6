#include "core/files/output_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

namespace regrasp {
namespace {

namespace fs = std::filesystem;

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
  const auto fail = [&](const std::string& cause) {
    throw WriteError("cannot write " + target + ": " + cause);
  };
  std::error_code error;
  fs::path directory = fs::absolute(target, error).parent_path();
  if (error) fail("the current directory has gone");
  while (!fs::exists(directory, error) && directory.has_relative_path())
    directory = directory.parent_path();
  if (!fs::is_directory(directory, error)) fail(directory.string() + " is no directory");
  if (::access(directory.c_str(), W_OK | X_OK) != 0)
    fail(directory.string() + ": " + std::strerror(errno));
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
