#pragma once

/// A file or directory that appears complete under its name, or not at all: it is made under
/// another name beside it, written to the disk and renamed.

#include <cstdint>
#include <string>
#include <string_view>

namespace regrasp {

class Draft {
 public:
  enum class Existing : std::uint8_t { kKeep, kReplace };  ///< a file that has the name already
  enum class Kind : std::uint8_t { kFile, kDirectory };

  /// Chooses a free name beside `target`, with its suffix; a directory is made (0777 less the
  /// umask), a file is for the caller to make. Directories above `target` are made where missing.
  /// Throws std::runtime_error with path and cause; with kKeep also when `target` exists.
  Draft(std::string target, Existing existing, Kind kind = Kind::kFile);
  /// Removes what was not committed.
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const std::string& path() const { return path_; }
  /// Has the data on the disk, then gives it its name: replacing, never following, what is there.
  /// `durable` false leaves the disk to the system. Throws std::runtime_error with path and cause;
  /// with kKeep also when somebody else has taken the name meanwhile.
  void Commit(bool durable = true);

 private:
  std::string target_, path_;
  Existing existing_;
  bool committed_ = false;
};

/// A whole file with this text. Throws what Draft throws.
void WriteWhole(const std::string& target, std::string_view text, Draft::Existing existing,
                bool durable = true);

/// For a program, at its start: nobody but the user may change what it writes (umask 022 at least).
void KeepFromOthers();

/// Removes what writers that have been killed left beside the files of a directory; of writers that
/// cannot be asked (another machine's, another container's) what was not written to for a day.
/// Never throws; what cannot be removed stays.
void RemoveAbandonedDrafts(const std::string& directory);

}  // namespace regrasp
