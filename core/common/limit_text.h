#pragma once

/// How a limit of a range is written wherever people read it: help, pages, errors.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace regrasp {

/// At most six digits, whole numbers with all of theirs, never an exponent: 0.00001, 3.14159,
/// 1000000; the largest integer that every JSON reader takes, and what is a little less, as 2^53
/// and "2^53 - 1000000". `value` is finite and of no smaller magnitude than 1e-9, or 0.
inline std::string LimitText(double value) {
  constexpr double kMost = 9007199254740992.0, kLittle = 1e12;
  if (value == kMost) return "2^53";
  if (value < kMost && value > kMost - kLittle)
    return std::string("2^53 - ").append(LimitText(kMost - value));
  const int whole = value == 0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value))));
  char text[400];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed,
                                          std::max(0, 5 - whole));
  std::string digits(text, end);
  if (digits.find('.') != std::string::npos) {
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
  }
  return digits;
}

}  // namespace regrasp
