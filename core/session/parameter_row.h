#pragma once

/// How a row of the parameter table is written (parameters.cc).

#include <array>
#include <cstddef>
#include <string_view>
#include <type_traits>

#include "core/session/parameters.h"

namespace regrasp::parameter_row {

/// Type, get and set of a row follow from the member that `Member` points at.
template <typename Member>
constexpr ParameterInfo RowOf(std::string_view name, std::string_view meaning,
                              std::string_view source, Member) {
  using T = std::remove_pointer_t<std::invoke_result_t<Member, Parameters&>>;
  ParameterInfo info;
  info.name = name;
  info.type = std::is_enum_v<T>             ? ParameterType::kWord
              : std::is_same_v<T, bool>     ? ParameterType::kBoolean
              : std::is_same_v<T, int>      ? ParameterType::kInteger
              : std::is_same_v<T, Vector3d> ? ParameterType::kVector
                                            : ParameterType::kReal;
  info.max = 1;
  info.meaning = meaning;
  info.source = source;
  info.get = [](const Parameters& parameters) -> Vector3d {
    const T& value = *Member{}(const_cast<Parameters&>(parameters));  // only read
    if constexpr (std::is_same_v<T, Vector3d>)
      return value;
    else
      return {static_cast<double>(value), 0, 0};
  };
  info.set = [](Parameters* parameters, const Vector3d& value) {
    if constexpr (std::is_same_v<T, Vector3d>)
      *Member{}(*parameters) = value;
    else if constexpr (std::is_enum_v<T>)
      *Member{}(*parameters) = static_cast<T>(static_cast<int>(value.x()));
    else
      *Member{}(*parameters) = static_cast<T>(value.x());
  };
  return info;
}

/// A real, an integer or a vector.
template <typename Member>
constexpr ParameterInfo Row(std::string_view name, std::string_view unit, double min, double max,
                            std::string_view meaning, std::string_view source, Member member) {
  ParameterInfo info = RowOf(name, meaning, source, member);
  info.unit = unit;
  info.min = min;
  info.max = max;
  return info;
}

/// A word.
template <std::size_t N, typename Member>
constexpr ParameterInfo Row(std::string_view name, const std::array<std::string_view, N>& words,
                            std::string_view meaning, std::string_view source, Member member) {
  ParameterInfo info = RowOf(name, meaning, source, member);
  info.words = words;
  info.max = static_cast<double>(N - 1);
  return info;
}

/// A boolean.
template <typename Member>
constexpr ParameterInfo Row(std::string_view name, std::string_view meaning,
                            std::string_view source, Member member) {
  return RowOf(name, meaning, source, member);
}

}  // namespace regrasp::parameter_row
