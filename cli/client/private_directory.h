#pragma once

#include <filesystem>

namespace regrasp::cli {

/// A directory for a private daemon: in $TMPDIR where its socket's path fits there, else in /tmp.
/// It goes with this object. One whose program was killed stays behind; the next to make one
/// removes it.
class PrivateDirectory {
 public:
  /// Throws CliError(kIo).
  PrivateDirectory();
  ~PrivateDirectory();
  PrivateDirectory(const PrivateDirectory&) = delete;
  PrivateDirectory& operator=(const PrivateDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path socket() const { return path_ / "regrasp.sock"; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;  ///< the directory, with a lock that ends with this program
};

}  // namespace regrasp::cli
