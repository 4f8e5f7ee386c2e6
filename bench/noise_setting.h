#pragma once

/// A level of the sensors' noise as it is typed for a program of this folder: noise.LEVEL=VALUE,
/// LEVEL a field of NoiseLevels.

#include <charconv>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/sensing/noise.h"

namespace regrasp {

struct NoiseSetting {
  std::string level;
  double value = 0;
};

/// Sets the level of this name. False where there is none.
inline bool Apply(const NoiseSetting& setting, NoiseLevels* levels) {
  bool found = false;
  const auto set = [&](std::string_view field, auto& level) {
    if (setting.level != field) return;
    level = static_cast<std::remove_reference_t<decltype(level)>>(setting.value);
    found = true;
  };
  levels->Fields(set);
  return found;
}

/// Reads "noise.position_bias_m=0.002". Throws std::runtime_error that says what is allowed.
inline NoiseSetting ReadNoiseSetting(const std::string& text) {
  const auto dot = text.find('.'), equals = text.find('=');
  if (dot == std::string::npos || equals == std::string::npos || equals < dot)
    throw std::runtime_error("no noise.LEVEL=VALUE: " + text);
  NoiseSetting setting{text.substr(dot + 1, equals - dot - 1)};
  NoiseLevels levels;
  if (!Apply(setting, &levels)) throw std::runtime_error(text + ": no level of the noise");
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + equals + 1, end, setting.value);
  if (error != std::errc() || rest != end || !(setting.value >= 0 && setting.value <= 1000))
    throw std::runtime_error(text + ": allowed: 0 ... 1000");
  return setting;
}

}  // namespace regrasp
