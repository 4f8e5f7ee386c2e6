#include "cli/grammar/grammar.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "cli/client/errors.h"
#include "cli/commands/hand.h"
#include "cli/commands/object.h"
#include "cli/grammar/flags.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {
namespace {

struct Unit {
  std::string_view suffix, metavar;
  double scale;
};
// SI on the wire, everyday units on the command line. Longer suffixes first.
constexpr double kDegree = std::numbers::pi / 180;
constexpr Unit kUnits[] = {{"_rad_s", "DEG_S", kDegree},
                           {"_rad", "DEG", kDegree},
                           {"_m", "MM", 1e-3},
                           {"_n", "N", 1},
                           {"_s", "S", 1},
                           {"_hz", "HZ", 1}};

const Unit* UnitOf(std::string_view key) {
  const auto unit =
      std::ranges::find_if(kUnits, [key](const Unit& u) { return key.ends_with(u.suffix); });
  return unit == std::end(kUnits) ? nullptr : unit;
}

Arg FromParam(const ParamSpec& param, bool positional) {
  Arg arg;
  arg.key = param.name;
  arg.help = param.sentence;
  arg.default_text = param.default_text;
  arg.required = param.required;
  arg.wire = true;
  arg.min = param.min;
  arg.max = param.max;
  if (const Unit* unit = UnitOf(param.name)) {
    arg.metavar = unit->metavar;
    arg.scale = unit->scale;
  }
  std::string name = FlagWord(param.name);
  if (!positional) arg.flags = "--" + name;
  switch (param.type) {
    case ParamType::kBool:
      arg.kind = ArgKind::kFlag;
      if (param.default_text != "true") break;
      arg.flags = "--no-" + name;  // what is there without it
      arg.help = "without " + arg.help;
      arg.default_text.clear();
      break;
    case ParamType::kInteger:
      arg.kind = ArgKind::kInteger;
      break;
    case ParamType::kNumber:
      arg.kind = ArgKind::kNumber;
      break;
    case ParamType::kVector3:
      arg.kind = ArgKind::kVector3;
      break;
    case ParamType::kParameterValue:
      arg.kind = ArgKind::kParameterValue;
      break;
    default:
      arg.kind = ArgKind::kText;
  }
  arg.values.assign(param.values.begin(), param.values.end());
  if (arg.metavar.empty()) arg.metavar = arg.kind == ArgKind::kVector3 ? "X,Y,Z" : "N";
  if (arg.kind == ArgKind::kVector3) {
    if (arg.scale != 1) arg.unit = arg.metavar;
    arg.metavar = "X,Y,Z";
  }
  if (arg.kind == ArgKind::kText || positional) {
    arg.metavar = name;
    std::transform(name.begin(), name.end(), arg.metavar.begin(), [](char c) {
      return static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    });
  }
  if (!positional && !arg.values.empty()) arg.metavar = "NAME";
  if (arg.kind == ArgKind::kFlag) arg.metavar.clear();
  return arg;
}

}  // namespace

std::string FlagWord(std::string_view key) {
  const Unit* unit = UnitOf(key);
  std::string word(key.substr(0, key.size() - (unit ? unit->suffix.size() : 0)));
  std::ranges::replace(word, '_', '-');
  return word;
}

Arg WaitFlag() {
  return {.key = "wait",
          .flags = "--wait",
          .metavar = "",
          .kind = ArgKind::kFlag,
          .help = "wait until the job has ended, print its record"};
}

Arg TextArg(std::string key, std::string flags, std::string metavar, std::string help,
            std::string default_text) {
  Arg arg;
  arg.key = std::move(key);
  arg.flags = std::move(flags);
  arg.metavar = std::move(metavar);
  arg.help = std::move(help);
  arg.default_text = std::move(default_text);
  return arg;
}

CommandSpec MethodCommand(std::string_view method, std::string group, Handler run,
                          const MethodArguments& arguments) {
  const MethodSpec* spec = FindMethod(method);
  if (spec == nullptr) throw std::logic_error("no method " + std::string(method));
  CommandSpec command{
      std::string(spec->words), std::move(group), std::string(spec->sentence), spec, {}, run};
  for (const auto& name : arguments.positional) {
    command.args.push_back(FromParam(*FindParam(*spec, name), true));
  }
  const auto among = [](const auto& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const auto& param : spec->params) {
    if (among(arguments.positional, param.name) || among(arguments.hidden, param.name)) continue;
    command.args.push_back(FromParam(param, false));
  }
  command.args.insert(command.args.end(), arguments.extra.begin(), arguments.extra.end());
  if (spec->job) command.args.push_back(WaitFlag());
  return command;
}

const std::vector<CommandSpec>& Commands() {
  static const std::vector<CommandSpec> kCommands = [] {
    std::vector<CommandSpec> all;
    for (auto* group :
         {RunCommands, ControlCommands, InspectCommands, ResultCommands, ExperimentCommands,
          HandCommands, ObjectCommands, ToolCommands, ConfigCommands}) {
      for (auto& command : group()) all.push_back(std::move(command));
    }
    return all;
  }();
  return kCommands;
}

std::vector<const CommandSpec*> FindCommands(std::string_view words) {
  std::vector<const CommandSpec*> found;
  for (const auto& command : Commands()) {
    if (command.words == words) return {&command};
    if (words.empty() || command.words.starts_with(std::string(words) + " "))
      found.push_back(&command);
  }
  return found;
}

double ParseNumber(const std::string& text, const std::string& what) {
  double value = 0;
  const char* begin = text.c_str() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.c_str() + text.size();
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || rest != end || begin == end || !std::isfinite(value)) {
    throw CliError(kUsage, fmt::format("{}: '{}' is not a finite number", what, text));
  }
  return value;
}

std::vector<double> ParseNumbers(const std::string& text, std::size_t count,
                                 const std::string& what) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (true) {
    const auto comma = text.find(',', begin);
    numbers.push_back(ParseNumber(text.substr(begin, comma - begin), what));
    if (comma == std::string::npos) break;
    begin = comma + 1;
  }
  if (numbers.size() != count) {
    throw CliError(
        kUsage, fmt::format("{}: '{}' has {} numbers, not {}", what, text, numbers.size(), count));
  }
  return numbers;
}

Json ParseParameterValue(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  try {
    const auto commas = std::count(text.begin(), text.end(), ',');
    if (commas == 0) return ParseNumber(text, "");
    if (commas == 2) return ParseNumbers(text, 3, "");
  } catch (const CliError&) {
    // A word.
  }
  return text;
}

}  // namespace regrasp::cli
