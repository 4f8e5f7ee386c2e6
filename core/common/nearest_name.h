#pragma once

/// "Did you mean ...?": the known name that is nearest to a mistyped one.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace regrasp {

/// Optimal string alignment distance: insertions, deletions, replacements and swaps of neighbours
/// that turn `a` into `b`; bytes, case-sensitive.
inline std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

/// Whether `mistakes` letters are few for a word of `length`: one of two, else a third.
inline bool AreFew(std::size_t mistakes, std::size_t length) {
  return 2 * mistakes <= length && (mistakes <= 1 || 3 * mistakes <= length);
}

/// How far a wanted name is from another.
struct NameDistance {
  std::size_t letters = 0;
  bool begun = false;  ///< only from the beginning of the other
};

/// Letter by letter; a name that is only begun (three letters or more) is as near as one with two
/// mistakes, and words that were left away at its end ("gait.speed" of "gait.speed_rad_s") count as
/// one, where a quarter of the rest at most is wrong. Empty when nothing is near.
inline std::optional<NameDistance> DistanceOf(std::string_view wanted, std::string_view name) {
  std::optional<NameDistance> least;
  const auto take = [&](std::size_t letters, bool begun) {
    if (!least || letters < least->letters) least = {letters, begun};
  };
  const std::size_t whole = EditDistance(wanted, name);
  if (AreFew(whole, std::max(wanted.size(), name.size()))) take(whole, false);
  for (std::size_t end = name.find('_'); end != std::string_view::npos;
       end = name.find('_', end + 1)) {
    const std::size_t letters = EditDistance(wanted, name.substr(0, end));
    if (4 * letters <= std::max(wanted.size(), end)) take(letters + 1, true);
  }
  if (wanted.size() >= 3 && name.starts_with(wanted)) take(2, true);
  return least;
}

/// The name of `names` (any range of things convertible to std::string_view) nearest to `wanted`;
/// of equals the one that begins more like it, then the first. Empty when none is near, or when it
/// is the beginning of several alike. `wanted` over 256 bytes is near to nothing.
template <typename Names>
std::string_view NearestName(std::string_view wanted, const Names& names) {
  if (wanted.size() > 256) return {};
  std::string_view best;
  NameDistance least;
  std::size_t best_same = 0;
  bool several = false;
  for (const auto& candidate : names) {
    const std::string_view name = candidate;
    const std::optional<NameDistance> distance = DistanceOf(wanted, name);
    if (!distance || name == best) continue;
    const auto differ = std::mismatch(wanted.begin(), wanted.end(), name.begin(), name.end());
    const auto same = static_cast<std::size_t>(differ.first - wanted.begin());
    const bool equal = !best.empty() && distance->letters == least.letters;
    if (best.empty() || distance->letters < least.letters || (equal && same > best_same)) {
      best = name;
      least = *distance;
      best_same = same;
      several = false;
    } else if (equal && same == best_same && distance->begun && least.begun) {
      several = true;
    }
  }
  return several ? std::string_view() : best;
}

/// "did you mean 'x'?", or "" when nothing is near.
template <typename Names>
std::string DidYouMean(std::string_view wanted, const Names& names) {
  const std::string_view near = NearestName(wanted, names);
  return near.empty() ? "" : "did you mean '" + std::string(near) + "'?";
}

/// The same for the end of a sentence, with "; " before it.
template <typename Names>
std::string OrNearest(std::string_view wanted, const Names& names) {
  const std::string text = DidYouMean(wanted, names);
  return text.empty() ? "" : "; " + text;
}

}  // namespace regrasp
