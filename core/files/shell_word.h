#pragma once

/// A word for a command that somebody may paste into a shell.

#include <string>

namespace regrasp {

/// `word` as a POSIX shell takes it for one word: quoted where it must be.
std::string ShellWord(const std::string& word);

}  // namespace regrasp
