#pragma once

#include <concepts>
#include <string>
#include <string_view>

namespace regrasp {

/// "1 joint", "3 joints", of a number as it is shown.
inline std::string CountText(std::string_view number, std::string_view thing) {
  return std::string(number) + ' ' + std::string(thing) + (number == "1" ? "" : "s");
}
inline std::string CountText(std::integral auto number, std::string_view thing) {
  return CountText(std::to_string(number), thing);
}

}  // namespace regrasp
