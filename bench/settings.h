#pragma once

/// Parameters as they are typed for a program of this folder: NAME=VALUE.

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/session/parameter_value.h"

namespace regrasp {

struct ParameterSetting {
  int parameter = 0;  ///< row of ParameterTable()
  Vector3d value = Vector3d::Zero();

  const ParameterInfo& info() const {
    return ParameterTable()[static_cast<std::size_t>(parameter)];
  }
};

/// Reads "gait.lead=0.25", "gait.mode=exploring", "gait.hop=false" or "gravity=0,0,-9.81". Throws
/// std::runtime_error that says what is allowed.
inline ParameterSetting ReadSetting(const std::string& text) {
  const auto equals = text.find('=');
  ParameterSetting setting;
  setting.parameter = FindParameter(text.substr(0, equals));
  if (equals == std::string::npos || setting.parameter < 0)
    throw std::runtime_error("no such PARAMETER=VALUE: " + text);
  const char* at = text.data() + equals + 1;
  const char* const end = text.data() + text.size();
  GivenValue given = std::string(at, end);
  std::vector<double> numbers;
  for (double number = 0;; ++at) {
    const auto [rest, error] = std::from_chars(at, end, number);
    if (error != std::errc() || (rest != end && *rest != ',')) break;
    numbers.push_back(number);
    at = rest;
    if (at != end) continue;
    given = numbers.size() == 1 ? GivenValue(numbers[0]) : GivenValue(numbers);
    break;
  }
  try {
    setting.value = ReadParameterValue(setting.info(), given);
  } catch (const ParameterError& error) {
    const std::string what = error.what();
    const bool said = error.hint == "allowed: " + error.allowed && what.ends_with(error.allowed);
    throw std::runtime_error(said ? what : what + "; " + error.hint);
  }
  return setting;
}

/// Sets all of them as a user does, presets first.
inline void Apply(std::vector<ParameterSetting> settings, Parameters* parameters) {
  std::ranges::stable_partition(settings, IsPreset, &ParameterSetting::info);
  for (const ParameterSetting& setting : settings)
    SetByUser(setting.info(), setting.value, parameters);
}

}  // namespace regrasp
