#pragma once

/// Tables with one row for each value of an enumeration, in its order: std::array of a struct with
/// `name`, and `id` where the order is checked.

#include <array>
#include <cstddef>
#include <string_view>

namespace regrasp {

/// Whether row i is of value i.
template <typename Row, std::size_t N>
constexpr bool InOrder(const std::array<Row, N>& table) {
  for (std::size_t i = 0; i < N; ++i)
    if (static_cast<std::size_t>(table[i].id) != i) return false;
  return true;
}

/// The names of the first `Count` rows.
template <std::size_t Count, typename Row, std::size_t N>
constexpr std::array<std::string_view, Count> NamesOf(const std::array<Row, N>& table) {
  static_assert(Count <= N);
  std::array<std::string_view, Count> names;
  for (std::size_t i = 0; i < Count; ++i) names[i] = table[i].name;
  return names;
}

}  // namespace regrasp
