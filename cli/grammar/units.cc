#include "cli/grammar/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "cli/client/errors.h"

namespace regrasp::cli {
namespace {

struct Unit {
  std::string_view name;
  char kind;     ///< units of one kind convert into each other
  double value;  ///< in SI
};
constexpr double kDegree = std::numbers::pi / 180;
constexpr Unit kUnits[] = {
    {"deg", 'a', kDegree}, {"rad", 'a', 1},     {"turn", 'a', 2 * std::numbers::pi},
    {"mm", 'l', 1e-3},     {"cm", 'l', 1e-2},   {"m", 'l', 1},
    {"um", 'l', 1e-6},     {"N", 'f', 1},       {"mN", 'f', 1e-3},
    {"s", 't', 1},         {"ms", 't', 1e-3},   {"min", 't', 60},
    {"Hz", 'h', 1},        {"kHz", 'h', 1e3},   {"deg/s", 'w', kDegree},
    {"rad/s", 'w', 1},     {"mm/s", 'v', 1e-3}, {"m/s", 'v', 1},
    {"kg", 'g', 1},        {"g", 'g', 1e-3},    {"m/s2", 'b', 1},
    {"N m", 'q', 1},       {"Nm", 'q', 1},      {"1/m", 'i', 1},
    {"1/mm", 'i', 1e3},    {"pt", 'p', 1},      {"N/m", 'k', 1},
    {"N/mm", 'k', 1e3}};

/// What a person types for one of them, alone or in a quotient: "degrees/second".
struct Spelling {
  std::string_view name;                  ///< of kUnits
  std::array<std::string_view, 6> typed;  ///< what is left of it is empty
};
constexpr Spelling kSpellings[] = {
    {"deg", {"degree", "degrees", "degs", "°"}},
    {"rad", {"radian", "radians", "rads"}},
    {"turn", {"turns"}},
    {"mm", {"millimetre", "millimetres", "millimeter", "millimeters"}},
    {"cm", {"centimetre", "centimetres", "centimeter", "centimeters"}},
    {"m", {"metre", "metres", "meter", "meters"}},
    {"um", {"micrometre", "micrometres", "micrometer", "micrometers", "µm", "μm"}},  // two letters
    {"N", {"newton", "newtons", "Newton", "Newtons"}},
    {"mN", {"millinewton", "millinewtons"}},
    {"s", {"second", "seconds", "sec", "secs"}},
    {"ms", {"millisecond", "milliseconds", "msec", "msecs"}},
    {"min", {"minute", "minutes", "mins"}},
    {"Hz", {"hertz", "Hertz"}},
    {"kHz", {"kilohertz", "kiloHertz"}},
    {"kg", {"kilogram", "kilograms", "kilogramme", "kilogrammes"}},
    {"g", {"gram", "grams", "gramme", "grammes"}},
    {"pt", {"point", "points"}}};

/// As grammar.cc has them; longer ends first.
constexpr std::pair<std::string_view, std::string_view> kKeyEnds[] = {
    {"_rad_s", "deg/s"}, {"_rad", "deg"}, {"_m", "mm"}, {"_n", "N"}, {"_s", "s"}, {"_hz", "Hz"}};

std::string_view NameOf(std::string_view typed) {
  if (typed.empty()) return typed;
  for (const Spelling& spelling : kSpellings)
    if (std::ranges::find(spelling.typed, typed) != spelling.typed.end()) return spelling.name;
  return typed;
}

const Unit* Find(std::string_view typed) {
  std::string name(NameOf(typed.substr(0, typed.find('/'))));
  if (const auto slash = typed.find('/'); slash != std::string_view::npos)
    name.append("/").append(NameOf(typed.substr(slash + 1)));
  for (const Unit& unit : kUnits)
    if (unit.name == name) return &unit;
  return nullptr;
}

/// The number at the front and what stands behind it; a number that is none leaves all behind.
std::pair<double, std::string_view> Split(const std::string& text) {
  double value = NAN;
  const char* begin = text.c_str() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.c_str() + text.size();
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || !std::isfinite(value)) return {NAN, text};
  const std::string_view behind(rest, static_cast<std::size_t>(end - rest));
  return {value, behind.substr(std::min(behind.find_first_not_of(' '), behind.size()))};
}

}  // namespace

double ParseQuantity(const std::string& text, const std::string& what, std::string_view unit) {
  const auto [value, behind] = Split(text);
  const Unit* own = Find(unit);
  const Unit* given = Find(behind);
  if (!std::isnan(value) && behind.empty()) return value;
  if (!std::isnan(value) && own && given && own->kind == given->kind)
    return given == own ? value : value * (given->value / own->value);
  if (std::isnan(value))
    throw CliError(kUsage, fmt::format("{}: '{}' is not a finite number", what, text));
  if (!own)
    throw CliError(kUsage, fmt::format("{}: '{}' has a unit; a bare number{}{} is allowed", what,
                                       text, unit.empty() ? "" : " of ", unit));
  std::string allowed;
  for (const Unit& other : kUnits)
    if (other.kind == own->kind) allowed += (allowed.empty() ? "" : ", ") + std::string(other.name);
  throw CliError(
      kUsage, fmt::format("{}: '{}' has the unit '{}'; allowed are {} (without one it is {})", what,
                          text, behind, allowed, unit));
}

bool HasUnit(const std::string& text) {
  const auto [value, behind] = Split(text);
  return !std::isnan(value) && !behind.empty() && behind.find(',') == std::string_view::npos;
}

std::vector<double> ParseQuantities(const std::string& text, std::size_t count,
                                    const std::string& what, std::string_view unit) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto comma = std::min(text.find(',', begin), text.size());
    numbers.push_back(ParseQuantity(text.substr(begin, comma - begin), what, unit));
    begin = comma + 1;
  }
  if (numbers.size() != count)
    throw CliError(
        kUsage, fmt::format("{}: '{}' has {} numbers, not {}", what, text, numbers.size(), count));
  return numbers;
}

std::string_view UnitOfKey(std::string_view key) {
  for (const auto& [end, unit] : kKeyEnds)
    if (key.ends_with(end)) return unit;
  return "";
}

}  // namespace regrasp::cli
