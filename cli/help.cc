#include "cli/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "cli/errors.h"
#include "cli/grammar.h"
#include "core/common/nearest_name.h"

namespace regrasp::cli {
namespace {

constexpr std::size_t kWidth = 80;

/// `text` broken at blanks into lines of at most 80 columns, the second and later ones indented.
std::string Wrap(const std::string& text, std::size_t indent) {
  std::string result, line;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const auto used = static_cast<std::size_t>(DisplayWidth(line));
    if (!line.empty() && used + 1 + word.size() > kWidth) {
      result += line + "\n";
      line = std::string(indent, ' ') + word;
    } else {
      line += (begin == 0 ? "" : " ") + word;
    }
    begin = end + 1;
  }
  return result + line + "\n";
}

std::string ArgLine(const Arg& arg) {
  std::string name = arg.flags.empty() ? arg.metavar : arg.flags;
  if (name.starts_with("--")) name = "    " + name;
  for (auto comma = name.find(','); comma != std::string::npos; comma = std::string::npos)
    name.replace(comma, 1, ", ");
  if (!arg.flags.empty() && !arg.metavar.empty()) name += " " + arg.metavar;
  std::string text = arg.help;
  if (!arg.values.empty()) text += fmt::format(": {}", fmt::join(arg.values, ", "));
  if (arg.kind != ArgKind::kText && arg.kind != ArgKind::kFlag && arg.max < 1e299) {
    text += fmt::format("; {:.6g} to {:.6g}", arg.min / arg.scale, arg.max / arg.scale);
  }
  if (!arg.default_text.empty()) text += fmt::format(" (default: {})", arg.default_text);
  return Wrap(fmt::format("  {:<24} {}", name, text), 27);
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
  if (!command.args.empty()) text += "\n";
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
                     " [OPTION]... COMMAND    hold, explore and turn an object in a hand\n";
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
  return text + "\nBegin with: regrasp up; regrasp grasp --wait; regrasp explore ring --wait\n";
}

/// The words that may follow `words`, and the options there.
std::string Followers(const std::string& words) {
  std::set<std::string> next;
  for (const auto* command : FindCommands(words)) {
    if (command->words == words) {
      for (const auto& arg : command->args) {
        if (arg.flags.empty()) next.insert(arg.values.begin(), arg.values.end());
        for (std::size_t begin = 0; begin < arg.flags.size();) {
          const auto comma = std::min(arg.flags.find(',', begin), arg.flags.size());
          next.insert(arg.flags.substr(begin, comma - begin));
          begin = comma + 1;
        }
      }
      return fmt::format("{}", fmt::join(next, " "));
    }
    const std::string rest = command->words.substr(words.empty() ? 0 : words.size() + 1);
    next.insert(rest.substr(0, rest.find(' ')));
  }
  return fmt::format("{}", fmt::join(next, " "));
}

/// Every path of words, with what may follow it, as the cases of a shell's `case`.
std::string Cases(const char* pattern) {
  std::set<std::string> paths = {""};
  for (const auto& command : Commands()) {
    for (auto end = command.words.find(' '); end != std::string::npos;
         end = command.words.find(' ', end + 1)) {
      paths.insert(command.words.substr(0, end));
    }
    paths.insert(command.words);
  }
  std::string text;
  for (const auto& path : paths) text += fmt::format(fmt::runtime(pattern), path, Followers(path));
  return text;
}

std::string GlobalWords() {
  std::string words;
  for (const auto& arg : GlobalArgs()) words += " " + arg.flags.substr(arg.flags.find("--"));
  return words;
}

}  // namespace

std::string HelpText(const std::string& words, const Output& out) {
  if (words.empty()) return Overview(out);
  const auto found = FindCommands(words);
  if (found.empty()) {
    std::vector<std::string_view> names;
    for (const auto& command : Commands()) names.push_back(command.words);
    const auto nearest = NearestName(words, names);
    throw CliError(kUsage, fmt::format("no command '{}'", words),
                   nearest.empty() ? "regrasp help" : fmt::format("regrasp help {}", nearest));
  }
  if (found.size() == 1 && found.front()->words == words) return CommandHelp(*found.front(), out);
  std::string text;
  for (const auto* command : found)
    text += Usage(*command) + "\n" + Wrap("  " + command->sentence, 2);
  return text;
}

std::string CompletionScript(const std::string& shell) {
  if (shell == "fish") {
    return "function __regrasp_words\n"
           "  set -l path (string match -rv '^-' -- (commandline -opc)[2..])\n"
           "  switch \"$path\"\n" +
           Cases("    case '{}'\n      string split ' ' -- '{}'\n") +
           "  end\nend\n"
           "complete -c regrasp -f -a '(__regrasp_words)'\n";
  }
  // zsh reads the bash script through its own compatibility layer.
  return std::string(shell == "zsh"
                         ? "#compdef regrasp\nautoload -U +X bashcompinit && bashcompinit\n"
                         : "") +
         "_regrasp() {\n"
         "  local path='' word i\n"
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    word=${COMP_WORDS[i]}\n"
         "    [[ $word == -* ]] || path=\"$path${path:+ }$word\"\n"
         "  done\n"
         "  case \"$path\" in\n" +
         Cases("    '{}') word='{}' ;;\n") +
         "    *) COMPREPLY=($(compgen -f -- \"${COMP_WORDS[COMP_CWORD]}\")); return ;;\n"
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$word" +
         GlobalWords() +
         "\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
         "}\n"
         "complete -F _regrasp regrasp\n";
}

}  // namespace regrasp::cli
