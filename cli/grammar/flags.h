#pragma once

/// The names of options.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/grammar/grammar.h"

namespace regrasp::cli {

/// How an argument's flag may be written: {"-o", "--output"}; of a positional one: none.
std::vector<std::string> Spellings(const Arg& arg);

/// What a parameter of the wire is called on the command line: "offset_m" -> "offset".
std::string FlagWord(std::string_view key);

/// The option of `own` or `global` that `typed` is a slip of, or "": of its own command where a
/// global one is not nearer. Dashes do not count, they would make every short name near.
std::string NearestFlag(std::string_view typed, std::span<const Arg> own,
                        std::span<const Arg> global);

}  // namespace regrasp::cli
