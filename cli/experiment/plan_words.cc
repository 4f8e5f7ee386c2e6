#include "cli/experiment/plan_words.h"

#include <fmt/format.h>

#include <set>
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

std::vector<std::string> NamesIn(const std::string& text, const std::string& flag,
                                 const std::string& whole) {
  const auto names = Split(text, ',');
  if (names.empty()) throw CliError(kUsage, fmt::format("{} is empty", flag));
  std::set<std::string> known;
  for (const std::string& name : names) {
    if (!known.insert(name).second)
      throw CliError(kUsage, fmt::format("{} {}: '{}' is given twice", flag, text, name));
    if (!whole.empty() && name == whole && names.size() > 1)
      throw CliError(kUsage, fmt::format("{} {}: '{}' stands for every name and goes alone", flag,
                                         text, name));
  }
  return names;
}

std::pair<int, int> ReadShard(const std::string& text) {
  const auto parts = Split(text, '/');
  const CliError bad(kUsage, fmt::format("--shard '{}' is not i/N with 1 <= i <= N", text));
  if (parts.size() != 2) throw bad;
  const double i = ParseNumber(parts[0], "--shard"), n = ParseNumber(parts[1], "--shard");
  if (i != static_cast<int>(i) || n != static_cast<int>(n) || i < 1 || i > n || n > 1e6) throw bad;
  return {static_cast<int>(i), static_cast<int>(n)};
}

}  // namespace regrasp::cli
