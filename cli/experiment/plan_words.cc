#include "cli/experiment/plan_words.h"

#include <fmt/format.h>

#include <sstream>

#include "cli/client/errors.h"
#include "cli/grammar/grammar.h"

namespace regrasp::cli {

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

std::pair<int, int> ReadShard(const std::string& text) {
  const auto parts = Split(text, '/');
  const CliError bad(kUsage, fmt::format("--shard '{}' is not i/N with 1 <= i <= N", text),
                     "regrasp help experiment exploration");
  if (parts.size() != 2) throw bad;
  const double i = ParseNumber(parts[0], "--shard"), n = ParseNumber(parts[1], "--shard");
  if (i != static_cast<int>(i) || n != static_cast<int>(n) || i < 1 || i > n || n > 1e6) throw bad;
  return {static_cast<int>(i), static_cast<int>(n)};
}

}  // namespace regrasp::cli
