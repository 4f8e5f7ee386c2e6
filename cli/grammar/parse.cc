#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <deque>
#include <set>

#include "cli/client/errors.h"
#include "cli/grammar/flags.h"
#include "cli/grammar/grammar.h"
#include "cli/grammar/units.h"
#include "cli/grammar/values.h"
#include "core/common/nearest_name.h"

// CLI11 splits the words; checking them is ours, because it accepts nan inside a range and says
// little about unknown words. Two of its habits are worked around below:
//  - fallthrough() is inherited only by subcommands that are added after it;
//  - without a maximum of one subcommand, `watch status` would read `status` as the command.

namespace regrasp::cli {
namespace {

constexpr int kMaxRepeats = 10000;

struct Given {
  const Arg* arg;
  std::string text;
  bool flag = false;
  CLI::Option* option = nullptr;
};

struct Node {
  CLI::App* app = nullptr;
  const CommandSpec* command = nullptr;
  std::deque<Given> given = {};
};

void AddArg(CLI::App* app, Given* given) {
  const Arg& arg = *given->arg;
  if (arg.kind == ArgKind::kFlag) {
    // --no-title sets title to false, as --title=false does.
    const bool takes_away = arg.wire && arg.flags.starts_with("--no-");
    given->option = app->add_flag(
        takes_away ? "!" + arg.flags + ",--" + arg.flags.substr(5) : arg.flags, given->flag);
  } else {
    given->option = app->add_option(arg.flags.empty() ? arg.key : arg.flags, given->text);
    if (arg.repeated) given->option->join('\n');
    if (arg.repeated && arg.flags.empty())
      given->option->expected(1, kMaxRepeats)->allow_extra_args();
  }
}

std::string HelpHint(const std::string& words) {
  return words.empty() ? "regrasp help" : "regrasp help " + words;
}

/// The error for the first word that CLI11 could not place.
CliError Unexpected(const std::string& word, const std::string& scope, const Node* node) {
  if (word.size() > 1 && word[0] == '-') {
    const std::string name = word.substr(0, word.find('='));
    if (name == "--wait" && node != nullptr && node->command != nullptr)
      return {kUsage, fmt::format("'{}' has nothing to wait for: it starts no job", scope),
              "regrasp " + scope};
    const bool known = node != nullptr && node->command != nullptr;
    const std::string nearest = NearestFlag(
        name, known ? std::span<const Arg>(node->command->args) : std::span<const Arg>(),
        GlobalArgs());
    return {
        kUsage,
        fmt::format("unknown option '{}'{}", name, scope.empty() ? "" : " of '" + scope + "'"),
        nearest.empty() ? HelpHint(scope) : fmt::format("{}    ({})", nearest, HelpHint(scope))};
  }
  if (node != nullptr && node->command != nullptr) {
    return {kUsage, fmt::format("'{}' takes no further argument '{}'", scope, word),
            HelpHint(scope)};
  }
  std::vector<std::string> names;
  for (const auto* command : FindCommands(scope)) {
    const std::string rest = command->words.substr(scope.empty() ? 0 : scope.size() + 1);
    names.push_back(rest.substr(0, rest.find(' ')));
  }
  const auto nearest = NearestName(word, names);
  const std::string full = scope.empty() ? word : scope + " " + word;
  return {kUsage, fmt::format("unknown command '{}'", full),
          nearest.empty() ? HelpHint(scope)
                          : fmt::format("regrasp {}{}", scope.empty() ? "" : scope + " ", nearest)};
}

/// "-.5" would be read as an option.
std::string ZeroBeforePoint(const std::string& word) {
  const bool bare = word.size() > 2 && word.starts_with("-.") && word[2] >= '0' && word[2] <= '9';
  return bare ? "-0" + word.substr(1) : word;
}

}  // namespace

std::span<const Arg> GlobalArgs() {
  static const std::vector<Arg> kArgs = {
      {.key = "socket",
       .flags = "-s,--socket",
       .metavar = "PATH",
       .help = "socket of the daemon",
       .default_text = "$REGRASP_SOCKET, or where `regrasp up` puts it"},
      {.key = "json",
       .flags = "--json",
       .metavar = "",
       .kind = ArgKind::kFlag,
       .help = "print one JSON object; streams print one a line"},
      {.key = "csv",
       .flags = "--csv",
       .metavar = "",
       .kind = ArgKind::kFlag,
       .help = "print comma-separated values"},
      {.key = "quiet",
       .flags = "-q,--quiet",
       .metavar = "",
       .kind = ArgKind::kFlag,
       .help = "print no answer, only errors"},
      {.key = "verbose",
       .flags = "-v,--verbose",
       .metavar = "",
       .kind = ArgKind::kFlag,
       .help = "print more"},
      {.key = "color",
       .flags = "--color",
       .metavar = "WHEN",
       .help = "colour and bars' glyphs",
       .values = {"auto", "always", "never"},
       .default_text = "auto; NO_COLOR turns it off"},
      {.key = "timeout",
       .flags = "--timeout",
       .metavar = "S",
       .kind = ArgKind::kNumber,
       .help = "wait so long for an answer, or with --wait for the end of the job",
       .min = 0.001,
       .max = 1e6,
       .default_text = "10; no limit with --wait"},
      {.key = "help",
       .flags = "-h,--help",
       .metavar = "",
       .kind = ArgKind::kFlag,
       .help = "help on a command"},
  };
  return kArgs;
}

bool WantsJson(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--") break;
    if (word == "--json" || word == "--json=1") return true;
  }
  return false;
}

namespace {

/// The last --json=… as it was typed: a 0 is read as "off".
std::string JsonWord(int argc, const char* const* argv) {
  std::string typed = "--json";
  for (int i = 1; i < argc && std::string_view(argv[i]) != "--"; ++i)
    if (std::string_view(argv[i]).starts_with("--json=")) typed = argv[i];
  return typed;
}

}  // namespace

Invocation Parse(int argc, const char* const* argv, GlobalOptions* options) {
  CLI::App app("regrasp");
  app.set_help_flag("-h,--help");
  app.fallthrough();
  app.require_subcommand(1);

  std::int64_t json = 0;
  bool version = false;
  std::string color, timeout;
  app.add_option("-s,--socket", options->socket);
  app.add_flag("--json", json)->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  if (options->json) json = 1;  // after add_flag, which sets it to 0
  app.add_flag("--csv", options->csv);
  app.add_flag("-q,--quiet", options->quiet);
  app.add_flag("-v,--verbose", options->verbose);
  app.add_flag("--version", version);
  app.add_option("--color", color);
  app.add_option("--timeout", timeout);

  // Only commands whose first word is among the arguments: building all of them is half of the
  // start-up.
  const std::set<std::string_view> words_given(argv + std::min(argc, 1), argv + argc);
  std::map<std::string, Node> nodes;
  for (const auto& command : Commands()) {
    if (!words_given.contains(std::string_view(command.words).substr(0, command.words.find(' '))))
      continue;
    CLI::App* parent = &app;
    for (std::size_t end = 0; end != std::string::npos;) {
      const std::size_t begin = end == 0 ? 0 : end + 1;
      end = command.words.find(' ', begin);
      const std::string path = command.words.substr(0, end);
      Node& node = nodes[path];
      if (node.app == nullptr) {
        node.app = parent->add_subcommand(command.words.substr(begin, end - begin));
        if (end != std::string::npos) node.app->require_subcommand(1);
      }
      parent = node.app;
    }
    Node& leaf = nodes[command.words];
    leaf.command = &command;
    for (const auto& arg : command.args)
      AddArg(leaf.app, &leaf.given.emplace_back(Given{&arg, "", false}));
  }

  const auto scope_words = [&app] {
    std::string words;
    for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
      at = at->get_subcommands().front();
      words += (words.empty() ? "" : " ") + at->get_name();
    }
    return words;
  };
  const auto find_node = [&nodes](const std::string& words) {
    const auto it = nodes.find(words);
    return it == nodes.end() ? nullptr : &it->second;
  };

  Invocation help;
  help.params = Json::object();
  help.command = FindCommands("help").front();
  try {
    std::vector<std::string> words;
    for (int i = argc - 1; i >= 1; --i) words.push_back(ZeroBeforePoint(argv[i]));
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    help.local["topic"] = scope_words();
    options->json = json > 0;
    return help;
  } catch (const CLI::ParseError& error) {
    const std::string scope = scope_words();
    const auto extra = app.remaining(true);
    if (!extra.empty()) throw Unexpected(extra.front(), scope, find_node(scope));
    if (version) {
      Invocation show;
      show.params = Json::object();
      show.command = FindCommands("version").front();
      options->json = json > 0;
      return show;
    }
    if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
      if (scope.empty() && ::isatty(STDIN_FILENO) == 1 && ::isatty(STDOUT_FILENO) == 1) {
        Invocation shell;
        shell.params = Json::object();
        shell.command = FindCommands("shell").front();
        options->json = json > 0;
        return shell;
      }
      std::vector<std::string> next;
      if (scope.empty()) {
        for (const CommandSpec& command : Commands())
          if (std::string word = command.words.substr(0, command.words.find(' '));
              std::find(next.begin(), next.end(), word) == next.end())
            next.push_back(std::move(word));
        throw CliError(kUsage, fmt::format("no command given: {}", fmt::join(next, ", ")),
                       HelpHint(scope));
      }
      for (const CommandSpec* command : FindCommands(scope))
        if (command->words != scope) next.push_back(command->words.substr(scope.size() + 1));
      throw CliError(kUsage,
                     fmt::format("'{}' needs a further word{}{}", scope, next.empty() ? "" : ": ",
                                 fmt::join(next, ", ")),
                     HelpHint(scope));
    }
    std::string cause = error.what();
    cause = cause.substr(0, cause.find('\n'));
    if (const std::size_t end = cause.find(": At Most 1 required"); end != std::string::npos)
      cause = cause.substr(0, end) + " is given twice; allowed is once";
    throw CliError(kUsage, cause, HelpHint(scope));
  }

  const std::string scope = scope_words();
  const Node& node = *find_node(scope);
  Invocation invocation;
  invocation.command = node.command;
  invocation.params = Json::object();
  try {
    if (json != 0 && json != 1) {
      throw CliError(kUsage, fmt::format("{}: this version writes format 1", JsonWord(argc, argv)),
                     "regrasp --json=1 " + scope);
    }
    options->json = json == 1;
    if (options->json && options->csv)
      throw CliError(kUsage, "--json and --csv exclude each other");
    if (options->quiet && options->verbose) throw CliError(kUsage, "-q and -v exclude each other");
    for (const auto& arg : GlobalArgs()) {
      if (arg.key == "color" && !color.empty()) {
        const std::string mode = ToWire(arg, color, scope);
        options->color = mode == "always"  ? ColorMode::kAlways
                         : mode == "never" ? ColorMode::kNever
                                           : ColorMode::kAuto;
      }
      if (arg.key == "timeout" && !timeout.empty())
        options->timeout_s = ToWire(arg, timeout, scope).get<double>();
    }
    for (const auto& given : node.given) {
      const Arg& arg = *given.arg;
      const bool present = given.option->count() > 0;
      if (!present && arg.required)
        throw CliError(kUsage, fmt::format("{} is missing", ArgName(arg)));
      const bool flag = arg.kind == ArgKind::kFlag;
      if (!present || (flag && !given.flag && !arg.wire)) continue;
      const Json value = flag ? Json(given.flag) : ToWire(arg, given.text, scope);
      if (arg.wire) {
        invocation.params[arg.key] = value;
      } else if (arg.kind == ArgKind::kNumber && HasUnit(given.text)) {
        invocation.local[arg.key] = fmt::format("{}", value.get<double>() / arg.scale);
      } else {
        invocation.local[arg.key] = given.text;
      }
    }
  } catch (CliError& error) {
    if (error.hint.empty()) error.hint = HelpHint(scope);
    throw;
  }
  return invocation;
}

}  // namespace regrasp::cli
