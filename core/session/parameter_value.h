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

/// what() names parameter and value.
class ParameterError : public std::invalid_argument {
 public:
  ParameterError(const std::string& message, std::string allowed_text,
                 const std::string& nearest = "")
      : std::invalid_argument(message),
        allowed(std::move(allowed_text)),
        hint(nearest.empty() ? "allowed: " + allowed : nearest) {}
  std::string allowed;  ///< AllowedText
  std::string hint;     ///< "did you mean 'x'?" or "allowed: …"
};

/// The value as the table's set() takes it. For a boolean 0 and 1 stand too, for a word its number:
/// former versions wrote them so. Throws ParameterError.
Vector3d ReadParameterValue(const ParameterInfo& info, const GivenValue& given);

/// "0.8", "true", "exploring", "[0, 0, -9.81]": shortest text that reads as the same value.
std::string ParameterText(const ParameterInfo& info, const Vector3d& value);

/// "0.01 ... 1 m", "an integer, 1 ... 1000", "true or false", "exploring or returning",
/// "3 numbers, each -50 ... 50 m/s2".
std::string AllowedText(const ParameterInfo& info);

/// Its values, where they can be listed.
std::vector<std::string> AllowedValues(const ParameterInfo& info);

}  // namespace regrasp
