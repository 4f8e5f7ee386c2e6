#pragma once

/// How the words of a plan are read, from arguments and from files alike.

#include <string>
#include <utility>
#include <vector>

namespace regrasp::cli {

std::vector<std::string> Split(const std::string& text, char separator);

/// Names separated by commas, as `flag` takes them. `whole`: the word for all of them, which stands
/// alone; empty: there is none. Throws CliError(kUsage) where there is no name, or one is given
/// twice.
std::vector<std::string> NamesIn(const std::string& text, const std::string& flag,
                                 const std::string& whole = "");

/// "i/N": this part, and how many there are. Throws CliError(kUsage).
std::pair<int, int> ReadShard(const std::string& text);

}  // namespace regrasp::cli
