#include "cli/help/help.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/client/errors.h"
#include "cli/help/examples.h"
#include "cli/help/wrap.h"
#include "core/common/limit_text.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {
namespace {

std::string Examples(std::string_view words, const Output& out) {
  std::string text;
  for (const Example& example : ExamplesOf(words)) {
    const bool fits = example.line.size() <= 36;
    text += fits ? fmt::format("  {:<36} {}\n", example.line, example.meaning)
                 : fmt::format("  {}\n{:>39}{}\n", example.line, "", example.meaning);
  }
  return text.empty() ? "" : out.Paint("Examples", Style::kBold) + "\n" + text + "\n";
}

std::string ArgLine(const Arg& arg) {
  std::string name = arg.flags.empty() ? arg.metavar : arg.flags;
  if (name.starts_with("--")) name = "    " + name;
  for (auto comma = name.find(','); comma != std::string::npos; comma = std::string::npos)
    name.replace(comma, 1, ", ");
  if (!arg.flags.empty() && !arg.metavar.empty()) name += " " + arg.metavar;
  return Wrap(fmt::format("  {:<24} {}", name, MeaningOf(arg)), 27);
}

std::string Usage(const CommandSpec& command) {
  std::string text = "regrasp " + command.words;
  for (const auto& arg : command.args) {
    if (arg.flags.empty()) text += arg.required ? " " + arg.metavar : " [" + arg.metavar + "]";
  }
  const bool options = std::any_of(command.args.begin(), command.args.end(),
                                   [](const Arg& a) { return !a.flags.empty(); });
  return text + (options ? " [OPTION]..." : "");
}

std::string CommandHelp(const CommandSpec& command, const Output& out) {
  std::string text =
      out.Paint(Usage(command), Style::kBold) + "\n" + Wrap("  " + command.sentence, 2);
  text += "\n" + Examples(command.words, out);
  if (!command.args.empty()) text += out.Paint("Arguments", Style::kBold) + "\n";
  for (const auto& arg : command.args) text += ArgLine(arg);
  if (command.method != nullptr && !command.method->result.empty()) {
    text += "\n" + Wrap(fmt::format("  Asks the daemon '{}'; with --json prints its answer: {}",
                                    command.method->name, command.method->result),
                        2);
  }
  return text + "\n  regrasp help lists the global options.\n";
}

std::string Overview(const Output& out) {
  std::string text = out.Paint("regrasp", Style::kBold) +
                     " [OPTION]... COMMAND    hold, explore and turn an object in a hand\n\n" +
                     Examples("", out);
  text.pop_back();
  std::string group;
  for (const auto& command : Commands()) {
    if (command.group != group) {
      group = command.group;
      text += "\n" + out.Paint(group, Style::kBold) + "\n";
    }
    std::string name = command.words;
    for (const auto& arg : command.args) {
      if (arg.flags.empty()) name += " " + (arg.required ? arg.metavar : "[" + arg.metavar + "]");
    }
    text += Wrap(fmt::format("  {:<24} {}", name, command.sentence), 27);
  }
  text += "\n" + out.Paint("Options", Style::kBold) + " (anywhere on the line)\n";
  for (const auto& arg : GlobalArgs()) text += ArgLine(arg);
  text += "\n" + out.Paint("Exit codes", Style::kBold) + "\n";
  for (const auto& exit : ExitTable())
    text += fmt::format("  {:>3}  {}\n", static_cast<int>(exit.code), exit.sentence);
  return text + "\nregrasp help COMMAND tells more, man regrasp everything.\n";
}

}  // namespace

std::string HelpText(const std::string& words, const Output& out) {
  if (words.empty()) return Overview(out);
  const auto found = FindCommands(words);
  if (found.empty()) {
    std::vector<std::string_view> names;
    for (const auto& command : Commands()) {  // or the first word of several
      names.push_back(command.words);
      names.push_back(names.back().substr(0, names.back().find(' ')));
    }
    const auto nearest = NearestName(words, names);
    throw CliError(kUsage, fmt::format("no command '{}'", words),
                   nearest.empty() ? "regrasp help" : fmt::format("regrasp help {}", nearest));
  }
  if (found.size() == 1 && found.front()->words == words) return CommandHelp(*found.front(), out);
  std::string text;
  for (const auto* command : found)
    text += Usage(*command) + "\n" + Wrap("  " + command->sentence, 2);
  text += "\n";
  for (const auto* command : found) {
    std::string examples = Examples(command->words, out);
    if (command != found.front()) examples.erase(0, examples.find('\n') + 1);
    if (!examples.empty()) text += examples.substr(0, examples.size() - 1);
  }
  return text;
}

std::string MeaningOf(const Arg& arg) {
  std::string text = arg.help;
  if (!arg.values.empty()) text += fmt::format(": {}", fmt::join(arg.values, ", "));
  if (arg.kind != ArgKind::kText && arg.kind != ArgKind::kFlag && arg.max < 1e299) {
    text +=
        fmt::format("; {} to {}", LeastText(arg.min / arg.scale), MostText(arg.max / arg.scale));
  }
  if (!arg.default_text.empty() && !arg.required)
    text += fmt::format(" (default: {})", arg.default_text);
  return text;
}

}  // namespace regrasp::cli
