#include "core/posture/finger_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

namespace regrasp {
namespace {

using Pairs = std::array<std::pair<std::string_view, std::string_view>, 6>;

/// Beginnings of words. What follows must be a part of a finger: "three" and "thigh" are no thumbs.
constexpr Pairs kBeginnings = {{{"th", "thumb"},
                                {"ff", "first"},
                                {"if", "first"},
                                {"mf", "middle"},
                                {"rf", "ring"},
                                {"lf", "little"}}};
/// Anywhere in a word: in nothing else that a hand has.
constexpr Pairs kWords = {{{"thumb", "thumb"},
                           {"index", "first"},
                           {"middle", "middle"},
                           {"pinky", "little"},
                           {"pinkie", "little"},
                           {"little", "little"}}};

bool IsPart(std::string_view rest) {
  static constexpr std::array<std::string_view, 24> kParts = {
      "",     "a",   "b",    "c",      "d",          "j",          "tip",     "distal",
      "dip",  "pip", "mcp",  "middle", "medial",     "proximal",   "knuckle", "base",
      "link", "hub", "bend", "finger", "metacarpal", "metacarpus", "joint",   "intermediate"};
  return std::ranges::find(kParts, rest) != kParts.end();
}

/// In lower case, parted where there is no letter or a capital follows a small letter.
std::vector<std::string> WordsOf(std::string_view name) {
  std::vector<std::string> words(1);
  bool small = false;
  for (const char letter : name) {
    const auto c = static_cast<unsigned char>(letter);
    if (std::isalpha(c) == 0 || (small && std::isupper(c) != 0)) words.emplace_back();
    if (std::isalpha(c) != 0) words.back() += static_cast<char>(std::tolower(c));
    small = std::islower(c) != 0;
  }
  return words;
}

std::string_view Told(std::string_view word) {
  for (const auto& [beginning, finger] : kBeginnings)
    if (word.starts_with(beginning) && IsPart(word.substr(beginning.size()))) return finger;
  for (const auto& [part, finger] : kWords)
    if (word.find(part) != std::string_view::npos) return finger;
  // "spring", "bearing": no finger.
  return word.starts_with("ring") && IsPart(word.substr(4)) ? "ring" : "";
}

}  // namespace

std::string FingerNameIn(std::string_view name) {
  for (const std::string& word : WordsOf(name))
    if (const std::string_view finger = Told(word); !finger.empty()) return std::string(finger);
  return "";
}

}  // namespace regrasp
