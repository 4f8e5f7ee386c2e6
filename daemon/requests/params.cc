#include "daemon/requests/params.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/common/limit_text.h"
#include "core/common/nearest_name.h"
#include "core/files/json_text.h"

namespace regrasp {
namespace {

[[noreturn]] void Refuse(const ParamSpec& spec, std::string message, std::string hint = {},
                         std::vector<std::string> allowed = {}) {
  throw RpcException(RpcError{ErrorCode::kInvalidParams, std::move(message), std::move(hint),
                              std::string(spec.name), std::move(allowed)});
}

std::string Shown(const JsonIn& value) {
  std::string text = JsonText(value);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

std::string Range(const ParamSpec& spec) {
  const bool low = spec.min > -1e299, high = spec.max < 1e299;
  const std::string unit = spec.unit.empty() ? "" : fmt::format(" {}", spec.unit);
  if (low && high) return fmt::format("{} ... {}{}", LeastText(spec.min), MostText(spec.max), unit);
  if (low) return fmt::format("at least {}{}", LeastText(spec.min), unit);
  if (high) return fmt::format("at most {}{}", MostText(spec.max), unit);
  return "any";
}

void CheckNumber(const ParamSpec& spec, const JsonIn& value, bool integer) {
  if (!value.is_number())
    Refuse(spec, fmt::format("{} = {}: expected {}", spec.name, Shown(value), Name(spec.type)));
  const double number = value.get<double>();
  if (!std::isfinite(number)) Refuse(spec, fmt::format("{} is not finite", spec.name));
  if (integer && number != std::floor(number))
    Refuse(spec, fmt::format("{} = {}: expected {}", spec.name, Shown(value), Name(spec.type)));
  // Beyond 2^53 the conversion to double rounds: compare the integer itself.
  const bool rounded = value.is_number_unsigned() &&
                       value.get<std::uint64_t>() > static_cast<std::uint64_t>(kMaxSafeInteger);
  if (number < spec.min || number > spec.max || (integer && rounded))
    Refuse(spec, fmt::format("{} = {} is out of range", spec.name, Shown(value)),
           fmt::format("allowed: {}", Range(spec)));
}

void CheckNumbers(const ParamSpec& spec, const JsonIn& value, std::size_t count, bool integer) {
  if (!value.is_array() || value.size() != count)
    Refuse(spec, fmt::format("{} = {}: expected {}", spec.name, Shown(value), Name(spec.type)));
  for (const JsonIn& item : value) CheckNumber(spec, item, integer);
}

void CheckWord(const ParamSpec& spec, const JsonIn& value, const NameLookup& names) {
  std::vector<std::string> allowed(spec.values.begin(), spec.values.end());
  if (spec.names != NameSource::kNone) allowed = names(spec.names);
  if (!value.is_string()) Refuse(spec, fmt::format("{} is not a string", spec.name), {}, allowed);
  const std::string& word = value.get_ref<const std::string&>();
  if (std::ranges::find(allowed, word) != allowed.end()) return;
  RpcError error;
  error.param = spec.name;
  error.hint = DidYouMean(word, allowed);
  // A finger is part of the grammar; models and parameters are things that may or may not be there.
  const bool finger = spec.names == NameSource::kFinger || spec.names == NameSource::kNone;
  const bool thing = !finger;
  error.code = thing ? ErrorCode::kNotFound : ErrorCode::kInvalidParams;
  error.message = thing ? fmt::format("no {} named {}", Name(spec.names), Shown(value))
                        : fmt::format("{} = {} is not allowed; allowed are {}", spec.name,
                                      Shown(value), fmt::join(allowed, ", "));
  if (error.hint.empty() && thing && spec.names != NameSource::kObject)
    error.hint = "call param.list for the list";
  error.allowed = std::move(allowed);
  throw RpcException(std::move(error));
}

void CheckValue(const ParamSpec& spec, const JsonIn& value, const NameLookup& names) {
  switch (spec.type) {
    case ParamType::kInteger:
      return CheckNumber(spec, value, true);
    case ParamType::kNumber:
      return CheckNumber(spec, value, false);
    case ParamType::kVector3:
      return CheckNumbers(spec, value, 3, false);
    case ParamType::kIntegerPair:
      return CheckNumbers(spec, value, 2, true);
    case ParamType::kParameterValue:
      if (!ToGivenValue(value))
        Refuse(spec, fmt::format("{} = {}: expected {}", spec.name, Shown(value), Name(spec.type)));
      return;
    case ParamType::kObject:
      if (!value.is_object())
        Refuse(spec, fmt::format("{} = {}: expected an object", spec.name, Shown(value)));
      return;
    case ParamType::kBool:
      if (!value.is_boolean())
        Refuse(spec, fmt::format("{} = {}: expected true or false", spec.name, Shown(value)));
      return;
    case ParamType::kString:
      if (!value.is_string()) Refuse(spec, fmt::format("{} is not a string", spec.name));
      return;
    case ParamType::kEnum:
      return CheckWord(spec, value, names);
  }
}

}  // namespace

std::optional<GivenValue> ToGivenValue(const JsonIn& json) {
  const auto finite = [](const JsonIn& x) {
    return x.is_number() && std::isfinite(x.get<double>());
  };
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_string()) return json.get<std::string>();
  if (finite(json)) return json.get<double>();
  if (json.is_array() && json.size() <= 3 && std::ranges::all_of(json, finite))
    return json.get<std::vector<double>>();
  return {};
}

Params::Params(const MethodSpec& method, const JsonIn& values, const NameLookup& names)
    : values_(values) {
  for (const auto& [key, value] : values.items()) {
    if (FindParam(method, key)) continue;
    RpcError error{ErrorCode::kInvalidParams,
                   fmt::format("{} has no parameter '{}'", method.name, key.substr(0, 64)),
                   {},
                   key.substr(0, 64),
                   {}};
    for (const ParamSpec& spec : method.params) error.allowed.emplace_back(spec.name);
    error.hint = method.params.empty() ? fmt::format("{} takes no parameters", method.name)
                                       : DidYouMean(key, error.allowed);
    throw RpcException(std::move(error));
  }
  for (const ParamSpec& spec : method.params) {
    const JsonIn* value = Find(spec.name);
    if (value) {
      CheckValue(spec, *value, names);
    } else if (spec.required) {
      std::vector<std::string> allowed(spec.values.begin(), spec.values.end());
      if (spec.names == NameSource::kFinger) allowed = names(spec.names);
      Refuse(spec,
             fmt::format("{} needs the parameter '{}': {}", method.name, spec.name, spec.sentence),
             {}, std::move(allowed));
    }
  }
}

const JsonIn* Params::Find(std::string_view name) const {
  const auto it = values_.find(name);
  return it == values_.end() ? nullptr : &*it;
}

bool Params::Has(std::string_view name) const { return Find(name) != nullptr; }

double Params::Number(std::string_view name, double fallback) const {
  const JsonIn* value = Find(name);
  return value ? value->get<double>() : fallback;
}

std::int64_t Params::Integer(std::string_view name, std::int64_t fallback) const {
  const JsonIn* value = Find(name);
  return value ? static_cast<std::int64_t>(value->get<double>()) : fallback;
}

bool Params::Bool(std::string_view name, bool fallback) const {
  const JsonIn* value = Find(name);
  return value ? value->get<bool>() : fallback;
}

std::string Params::String(std::string_view name, const std::string& fallback) const {
  const JsonIn* value = Find(name);
  return value ? value->get<std::string>() : fallback;
}

Vector3d Params::Vector(std::string_view name, const Vector3d& fallback) const {
  const JsonIn* value = Find(name);
  if (!value) return fallback;
  return {(*value)[0].get<double>(), (*value)[1].get<double>(), (*value)[2].get<double>()};
}

const JsonIn& Params::Object(std::string_view name) const { return *Find(name); }

GivenValue Params::Given(std::string_view name) const { return *ToGivenValue(*Find(name)); }

std::pair<int, int> Params::Pair(std::string_view name) const {
  const JsonIn& value = *Find(name);
  return {static_cast<int>(value[0].get<double>()), static_cast<int>(value[1].get<double>())};
}

}  // namespace regrasp
