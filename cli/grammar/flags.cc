#include "cli/grammar/flags.h"

#include <algorithm>

#include "core/common/nearest_name.h"

namespace regrasp::cli {
namespace {

std::string_view Bare(std::string_view flag) {
  return flag.substr(std::min(flag.find_first_not_of('-'), flag.size()));
}

/// An option, and how far what was typed is from it.
struct Near {
  std::string flag;  ///< "": none is near
  std::size_t distance = 0;
};

Near Nearest(std::string_view typed, std::span<const Arg> args) {
  std::vector<std::string> words, flags;
  for (const Arg& arg : args) {
    for (const std::string& flag : Spellings(arg)) {
      words.emplace_back(Bare(flag));
      flags.push_back(flag);
    }
    // What the wire calls otherwise: the offset of move is --by.
    if (!arg.wire || arg.flags.empty()) continue;
    words.push_back(FlagWord(arg.key));
    flags.push_back(Spellings(arg).back());
  }
  const std::string_view word = NearestName(Bare(typed), words);
  if (word.empty()) return {};
  const auto found = std::ranges::find(words, word) - words.begin();
  return {flags[static_cast<std::size_t>(found)], EditDistance(Bare(typed), word)};
}

}  // namespace

std::vector<std::string> Spellings(const Arg& arg) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < arg.flags.size();) {
    const auto comma = std::min(arg.flags.find(',', begin), arg.flags.size());
    names.push_back(arg.flags.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return names;
}

std::string NearestFlag(std::string_view typed, std::span<const Arg> own,
                        std::span<const Arg> global) {
  const Near here = Nearest(typed, own), everywhere = Nearest(typed, global);
  if (here.flag.empty()) return everywhere.flag;
  return !everywhere.flag.empty() && everywhere.distance < here.distance ? everywhere.flag
                                                                         : here.flag;
}

}  // namespace regrasp::cli
