#pragma once

/// How the words of a plan are read, from arguments and from files alike.

#include <string>
#include <utility>
#include <vector>

namespace regrasp::cli {

std::vector<std::string> Split(const std::string& text, char separator);

/// "i/N": this part, and how many there are. Throws CliError(kUsage).
std::pair<int, int> ReadShard(const std::string& text);

}  // namespace regrasp::cli
