#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

namespace regrasp {

/// One capital or digit for each finger, no two alike: the initial of a name that begins like no
/// other (F, M, R, L, T of the Shadow Hand); else the last letter or digit of the name that is not
/// taken (1, 2, 3 of finger1, finger2, finger3), else a digit.
inline std::vector<char> FingerLetters(const std::vector<std::string>& names) {
  const auto capital = [](char c) {
    return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  };
  std::vector<char> letters(names.size(), '\0');
  const auto taken = [&](char c) { return std::ranges::find(letters, c) != letters.end(); };
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty() || !std::isalnum(static_cast<unsigned char>(names[i].front()))) continue;
    const auto alike = std::ranges::count_if(names, [&](const std::string& other) {
      return !other.empty() && capital(other.front()) == capital(names[i].front());
    });
    if (alike == 1) letters[i] = capital(names[i].front());
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (letters[i] != '\0') continue;
    std::string choice(names[i].rbegin(), names[i].rend());
    choice += "123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ";
    for (const char c : choice)
      if (std::isalnum(static_cast<unsigned char>(c)) && !taken(capital(c))) {
        letters[i] = capital(c);
        break;
      }
  }
  return letters;
}

}  // namespace regrasp
