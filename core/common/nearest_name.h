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

/// How far `wanted` is from `name`: letter by letter; a name that is only begun (three letters or
/// more) is as near as one with two mistakes, and a word that was left away at its end
/// ("gait.speed" of "gait.speed_rad_s") counts as one. Empty when nothing is near: more than half
/// of the longer word differs.
inline std::optional<std::size_t> NameDistance(std::string_view wanted, std::string_view name) {
  std::optional<std::size_t> least;
  const auto take = [&](std::string_view part, std::size_t more) {
    const std::size_t letters = EditDistance(wanted, part);
    if (2 * letters <= std::max(wanted.size(), part.size()))
      least = std::min(least.value_or(letters + more), letters + more);
  };
  take(name, 0);
  for (std::size_t end = name.find('_'); end != std::string_view::npos;
       end = name.find('_', end + 1))
    take(name.substr(0, end), 1);
  if (wanted.size() >= 3 && name.starts_with(wanted))
    least = std::min<std::size_t>(least.value_or(2), 2);
  return least;
}

/// The name of `names` (any range of things convertible to std::string_view) nearest to `wanted`;
/// of equals the one that begins more like it, then the first. Empty when none is near. `wanted`
/// over 256 bytes is near to nothing.
template <typename Names>
std::string_view NearestName(std::string_view wanted, const Names& names) {
  if (wanted.size() > 256) return {};
  std::string_view best;
  std::size_t best_distance = 0, best_same = 0;
  for (const auto& candidate : names) {
    const std::string_view name = candidate;
    const std::optional<std::size_t> distance = NameDistance(wanted, name);
    if (!distance) continue;
    const auto differ = std::mismatch(wanted.begin(), wanted.end(), name.begin(), name.end());
    const auto same = static_cast<std::size_t>(differ.first - wanted.begin());
    if (best.empty() || *distance < best_distance ||
        (*distance == best_distance && same > best_same)) {
      best = name;
      best_distance = *distance;
      best_same = same;
    }
  }
  return best;
}

/// "; did you mean 'x'?", for the end of a sentence, or "" when nothing is near.
template <typename Names>
std::string OrNearest(std::string_view wanted, const Names& names) {
  const std::string_view near = NearestName(wanted, names);
  return near.empty() ? "" : "; did you mean '" + std::string(near) + "'?";
}

}  // namespace regrasp
