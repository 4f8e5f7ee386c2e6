#pragma once

/// Files that a program or a library writes by their name, made as drafts.

#include <functional>
#include <stdexcept>
#include <string>

#include "core/files/draft.h"

namespace regrasp {

/// What cannot be written: the file by its own name, not its draft's, and the cause.
class WriteError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Before long work: throws WriteError where `target` has no name, where nothing can be made in its
/// directory (WhyNoOutput); with kKeep where it exists; with kReplace where its directory does not.
void CheckWritable(const std::string& target, Draft::Existing existing);

/// Why nothing can be made in `directory` (empty: the current one), or above it where it is not
/// there yet: "" where it can. Tried, not asked: where a user may write, a file system may refuse
/// all the same. That a disk is full is no reason: it may pass.
std::string WhyNoOutput(const std::string& directory);

/// Has `write` make a draft beside `target`, with its suffix, and renames it: a reader sees the old
/// file or the new one, and a symbolic link is replaced, not followed. Throws WriteError, and what
/// `write` throws that does not name the draft.
void WriteOutput(const std::string& target, Draft::Existing existing,
                 const std::function<void(const std::string& draft)>& write,
                 Draft::Kind kind = Draft::Kind::kFile);

}  // namespace regrasp
