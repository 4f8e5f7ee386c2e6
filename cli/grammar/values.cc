#include "cli/grammar/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "cli/client/errors.h"
#include "cli/grammar/units.h"
#include "core/common/limit_text.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {
namespace {

/// Of a bare number: the key on the wire tells it, or the word that stands for the value.
std::string_view UnitOf(const Arg& arg) {
  constexpr std::pair<std::string_view, std::string_view> kMetavars[] = {
      {"DEG", "deg"}, {"DEG_S", "deg/s"}, {"MM", "mm"}, {"S", "s"}, {"HZ", "Hz"}};
  if (const std::string_view unit = UnitOfKey(arg.key); !unit.empty()) return unit;
  for (const auto& [metavar, unit] : kMetavars)
    if (arg.metavar == metavar) return unit;
  return "";
}

void CheckRange(const Arg& arg, double typed) {
  const double value = typed * arg.scale;
  // Half a rounding of the unit conversion: the limit itself, typed in degrees, is allowed.
  const double slack = 1e-12 * std::abs(value);
  if (value >= arg.min - slack && value <= arg.max + slack) return;
  const std::string_view own = UnitOf(arg);
  const std::string unit = own.empty() ? arg.unit : std::string(own);
  const std::string behind = unit.empty() ? "" : " " + unit;
  const std::string least = LeastText(arg.min / arg.scale);
  throw CliError(kUsage, arg.max >= 1e299
                             ? fmt::format("{} {}: allowed are {}{} and more", ArgName(arg), typed,
                                           least, behind)
                             : fmt::format("{} {}: allowed are {} to {}{}", ArgName(arg), typed,
                                           least, MostText(arg.max / arg.scale), behind));
}

/// Whether these digits are an integer of at most 2^53 in magnitude.
bool IsExact(const std::string& text) {
  constexpr auto kMost = static_cast<std::int64_t>(kMaxSafeInteger);
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && rest == text.data() + text.size() && value <= kMost &&
         value >= -kMost;
}

}  // namespace

std::string ArgName(const Arg& arg) {
  if (arg.flags.empty()) return arg.metavar;
  return arg.flags.substr(arg.flags.find("--") == std::string::npos ? 0 : arg.flags.find("--"));
}

Json ToWire(const Arg& arg, const std::string& text, const std::string& scope) {
  const std::string name = ArgName(arg);
  switch (arg.kind) {
    case ArgKind::kFlag:
      return true;
    case ArgKind::kText: {
      if (arg.values.empty() ||
          std::find(arg.values.begin(), arg.values.end(), text) != arg.values.end()) {
        return text;
      }
      const auto nearest = NearestName(text, arg.values);
      throw CliError(kUsage,
                     fmt::format("{} '{}' is none of {}", name, text, fmt::join(arg.values, ", ")),
                     nearest.empty() ? ""
                                     : fmt::format("regrasp {}{} {}", scope,
                                                   arg.flags.empty() ? "" : " " + name, nearest));
    }
    case ArgKind::kInteger: {
      const double typed = ParseNumber(text, name);
      if (typed != std::floor(typed))
        throw CliError(kUsage, fmt::format("{}: '{}' is not an integer", name, text));
      // Beyond 2^53 a double is the nearest even integer, which nobody has typed.
      if (std::abs(typed) >= kMaxSafeInteger && !IsExact(text))
        throw CliError(kUsage, fmt::format("{} {}: allowed are {} to {}", name, text,
                                           LeastText(std::max(arg.min, -kMaxSafeInteger)),
                                           MostText(std::min(arg.max, kMaxSafeInteger))));
      CheckRange(arg, typed);
      return static_cast<std::int64_t>(typed);
    }
    case ArgKind::kNumber: {
      const double typed = ParseQuantity(text, name, UnitOf(arg));
      CheckRange(arg, typed);
      return typed * arg.scale;
    }
    case ArgKind::kParameterValue:
      return ParseParameterValue(text);
    case ArgKind::kVector3: {
      Json vector = Json::array();
      for (const double typed : ParseQuantities(text, 3, name, UnitOf(arg))) {
        CheckRange(arg, typed);
        vector.push_back(typed * arg.scale);
      }
      return vector;
    }
  }
  return text;
}

}  // namespace regrasp::cli
