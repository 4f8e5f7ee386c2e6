#pragma once

/// Values of parameters as people, files and requests write them: checked against their row of the
/// table, with errors that say what is allowed.

#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/session/parameters.h"

namespace regrasp {

/// What somebody gives for a parameter: true or false, a number, a word, or several numbers.
using GivenValue = std::variant<bool, double, std::string, std::vector<double>>;

/// what() names parameter and value; `allowed` what it may be, where what() does not; `nearest` the
/// word that was probably meant, or "".
class ParameterError : public std::invalid_argument {
 public:
  ParameterError(const std::string& message, std::string what_is_allowed,
                 std::string_view nearest_word = {})
      : std::invalid_argument(message),
        allowed(std::move(what_is_allowed)),
        nearest(nearest_word) {}
  std::string allowed, nearest;
  /// "did you mean 'x'?", "allowed: …", or "" where what() has said it.
  std::string Hint() const {
    if (!nearest.empty()) return "did you mean '" + nearest + "'?";
    return allowed.empty() ? "" : "allowed: " + allowed;
  }
};

/// The value as the table's set() takes it. For a boolean 0 and 1 stand too, for a word its number:
/// former versions wrote them so. Throws ParameterError.
Vector3d ReadParameterValue(const ParameterInfo& info, const GivenValue& given);

/// "0.8", "true", "exploring", "[0, 0, -9.81]": shortest text that reads as the same value.
std::string ParameterText(const ParameterInfo& info, const Vector3d& value);

/// "0.01 ... 1 m", "an integer, 1 ... 1000", "true or false", "exploring or returning",
/// "3 numbers, each -50 ... 50 m/s2".
std::string AllowedText(const ParameterInfo& info);

}  // namespace regrasp
