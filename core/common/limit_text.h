#pragma once

/// How a limit of a range is written wherever people read it: help, pages, errors.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace regrasp {

namespace limit_text {

inline std::string Digits(double value, int places) {
  char text[400];
  const auto [end, error] =
      std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, places);
  std::string digits(text, end);
  if (digits.find('.') != std::string::npos) {
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
  }
  return digits;
}

/// `inward`: 1 for a least value, -1 for a most: what is written is allowed, so never rounded out
/// of the range, but for the rounding of a unit's conversion.
inline std::string Text(double value, int inward) {
  constexpr double kMost = 9007199254740992.0, kLittle = 1e12, kConversion = 1e-12;
  if (value == kMost) return "2^53";
  if (value < kMost && value > kMost - kLittle)
    return std::string("2^53 - ").append(Text(kMost - value, -inward));
  const int whole = value == 0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(value))));
  const int places = std::max(0, 5 - whole);
  const std::string nearest = Digits(value, places);
  double written = 0;
  std::from_chars(nearest.data(), nearest.data() + nearest.size(), written);
  if (inward * (value - written) <= kConversion * std::abs(value)) return nearest;
  return Digits(written + inward * std::pow(10.0, -places), places);
}

}  // namespace limit_text

/// At most six digits, whole numbers with all of theirs, never an exponent: 0.00001, 3.14159,
/// 1000000; the largest integer that every JSON reader takes, and what is a little less, as 2^53
/// and "2^53 - 1000000". The last digit is rounded into the range. `value` is finite and of no
/// smaller magnitude than 1e-9, or 0.
inline std::string LeastText(double value) { return limit_text::Text(value, 1); }
inline std::string MostText(double value) { return limit_text::Text(value, -1); }

}  // namespace regrasp
