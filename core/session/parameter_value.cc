#include "core/session/parameter_value.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/common/limit_text.h"
#include "core/common/nearest_name.h"

namespace regrasp {
namespace {

constexpr std::size_t kMostShown = 60;  // characters of a value in a message

std::string Number(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value + 0.0);  // no -0
  return {text, end};
}

std::string Listed(const std::vector<double>& numbers) {
  std::string text = "[";
  for (const double x : numbers) text.append(text.size() > 1 ? ", " : "").append(Number(x));
  return text + "]";
}

/// The value as it was given, for messages.
std::string Shown(const GivenValue& given) {
  if (const bool* flag = std::get_if<bool>(&given)) return *flag ? "true" : "false";
  if (const double* number = std::get_if<double>(&given)) return Number(*number);
  if (const std::string* word = std::get_if<std::string>(&given)) {
    std::size_t end = std::min(kMostShown, word->size());
    while (end < word->size() && (static_cast<unsigned char>((*word)[end]) & 0xC0) == 0x80) --end;
    return "'" + word->substr(0, end) + (end < word->size() ? "...'" : "'");
  }
  const auto& numbers = std::get<std::vector<double>>(given);
  if (numbers.size() > 3) return std::to_string(numbers.size()) + " numbers";
  return Listed(numbers);
}

/// A string that would be right without its quotes.
bool IsQuotedNumber(const GivenValue& given) {
  const std::string* word = std::get_if<std::string>(&given);
  double number = 0;
  if (!word || word->empty()) return false;
  const char* end = word->data() + word->size();
  const auto [rest, error] = std::from_chars(word->data(), end, number);
  return error == std::errc() && rest == end;
}

[[noreturn]] void Refuse(const ParameterInfo& info, const GivenValue& given) {
  const std::string name(info.name);
  std::string message = name + " = " + Shown(given) + ": expected " + AllowedText(info);
  const bool scalar = info.type == ParameterType::kReal || info.type == ParameterType::kInteger;
  if (scalar && IsQuotedNumber(given))
    message = name + " is a number, and " + Shown(given) + " is text: leave out the quotes";
  else if (scalar && !std::holds_alternative<double>(given))
    message = name + " is one number" +
              (info.type == ParameterType::kReal ? ", with a point" : " without fraction") +
              ", not " + Shown(given);
  if (info.type == ParameterType::kVector && !std::holds_alternative<double>(given))
    message = name + " is 3 numbers, not " + Shown(given);
  throw ParameterError(message, AllowedText(info));
}

void CheckRange(const ParameterInfo& info, double value) {
  if (value >= info.min && value <= info.max) return;  // false for NaN
  throw ParameterError(std::string(info.name) + " = " + Number(value) + " is out of range",
                       AllowedText(info));
}

double ReadBoolean(const ParameterInfo& info, const GivenValue& given) {
  if (const bool* flag = std::get_if<bool>(&given)) return *flag;
  if (const double* number = std::get_if<double>(&given))
    if (*number == 0 || *number == 1) return *number;
  if (const std::string* word = std::get_if<std::string>(&given))
    if (*word == "true" || *word == "false") return *word == "true";
  Refuse(info, given);
}

double ReadWord(const ParameterInfo& info, const GivenValue& given) {
  if (const std::string* word = std::get_if<std::string>(&given)) {
    const auto found = std::ranges::find(info.words, *word);
    if (found != info.words.end()) return static_cast<double>(found - info.words.begin());
    throw ParameterError(
        std::string(info.name) + " = " + Shown(given) + ": expected " + AllowedText(info),
        AllowedText(info), DidYouMean(*word, info.words));
  }
  const double* number = std::get_if<double>(&given);
  if (number && *number == std::floor(*number) && *number >= info.min && *number <= info.max)
    return *number;
  Refuse(info, given);
}

}  // namespace

Vector3d ReadParameterValue(const ParameterInfo& info, const GivenValue& given) {
  switch (info.type) {
    case ParameterType::kBoolean:
      return {ReadBoolean(info, given), 0, 0};
    case ParameterType::kWord:
      return {ReadWord(info, given), 0, 0};
    case ParameterType::kVector: {
      const auto* numbers = std::get_if<std::vector<double>>(&given);
      if (!numbers || numbers->size() != 3) Refuse(info, given);
      for (const double x : *numbers) CheckRange(info, x);
      return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
    }
    case ParameterType::kReal:
    case ParameterType::kInteger:
      break;
  }
  const double* number = std::get_if<double>(&given);
  if (!number) Refuse(info, given);
  CheckRange(info, *number);
  if (info.type == ParameterType::kInteger && *number != std::floor(*number)) Refuse(info, given);
  return {*number, 0, 0};
}

std::string ParameterText(const ParameterInfo& info, const Vector3d& value) {
  switch (info.type) {
    case ParameterType::kBoolean:
      return value.x() != 0 ? "true" : "false";
    case ParameterType::kWord:
      return std::string(info.words[static_cast<std::size_t>(value.x())]);
    case ParameterType::kVector:
      return Listed({value.x(), value.y(), value.z()});
    case ParameterType::kReal:
    case ParameterType::kInteger:
      break;
  }
  return Number(value.x());
}

std::string AllowedText(const ParameterInfo& info) {
  if (info.type == ParameterType::kBoolean) return "true or false";
  if (info.type == ParameterType::kWord) {
    std::string text;
    for (std::size_t i = 0; i < info.words.size(); ++i) {
      const bool last = i + 1 == info.words.size();
      text += (i == 0 ? "" : last ? " or " : ", ") + std::string(info.words[i]);
    }
    return text;
  }
  std::string text = LeastText(info.min) + " ... " + MostText(info.max);
  if (!info.unit.empty()) text.append(" ").append(info.unit);
  if (info.type == ParameterType::kInteger) return std::string("an integer, ").append(text);
  return info.type == ParameterType::kVector ? std::string("3 numbers, each ").append(text) : text;
}

std::vector<std::string> AllowedValues(const ParameterInfo& info) {
  if (info.type == ParameterType::kBoolean) return {"true", "false"};
  return {info.words.begin(), info.words.end()};
}

}  // namespace regrasp
