#include "cli/help/manual.h"

#include <fmt/format.h>

#include <cctype>

#include "cli/grammar/flags.h"
#include "cli/grammar/grammar.h"
#include "cli/help/examples.h"
#include "cli/help/help.h"

namespace regrasp::cli {
namespace {

std::string Escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '_' || c == '*' || c == '\\' || c == '`') out += '\\';
    out += c;
  }
  return out;
}

std::string Sentence(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return Escaped(text) + ".";
}

std::string Flags(const Arg& arg) {
  std::string text;
  for (const std::string& flag : Spellings(arg))
    text += fmt::format("{}*{}*", text.empty() ? "" : ", ", Escaped(flag));
  if (!arg.metavar.empty()) text += fmt::format("{}_{}_", text.empty() ? "" : " ", arg.metavar);
  return text;
}

std::string Definition(const Arg& arg) {
  return fmt::format("{}\n\t{}.\n\n", Flags(arg), Escaped(MeaningOf(arg)));
}

std::string Examples(std::string_view words) {
  std::string text;
  for (const Example& example : ExamplesOf(words)) text += fmt::format("{}\n", example.line);
  return text.empty() ? "" : "```\n" + text + "```\n\n";
}

std::string Section(const CommandSpec& command) {
  std::string text = fmt::format("## {}", command.words);
  for (const Arg& arg : command.args)
    if (arg.flags.empty()) text += " " + (arg.required ? arg.metavar : "[" + arg.metavar + "]");
  text += fmt::format("\n\n{}\n\n", Sentence(command.sentence));
  text += Examples(command.words);
  for (const Arg& arg : command.args) text += Definition(arg);
  return text;
}

constexpr const char* kBeginning = R"(regrasp(1) "" "regrasp"

# NAME

regrasp - hold, explore and turn an object in a simulated hand

# SYNOPSIS

*regrasp* [_OPTION_]... _COMMAND_ [_ARGUMENT_]...

# EXAMPLES

)";

constexpr const char* kDescription = R"(# DESCRIPTION

*regrasp* talks to *regraspd*(8), which simulates a hand of 22 joints and its controller. *regrasp up*
starts a daemon of your own. Commands that take long start a job; with *--wait* they end when it does.
An interrupted wait leaves the job running and says how to find it.

The answer goes to standard output, and nothing else does; errors are a line with the cause and a line
with the next command to try, on standard error.

# OPTIONS

Anywhere on the line.

)";

constexpr const char* kEnd = R"(# ENVIRONMENT

*REGRASP\_SOCKET*
	Socket of the daemon; *-s* beats it, and it beats *socket* in the configuration file.

*REGRASP\_CONFIG*
	The configuration file, instead of the usual ones.

*REGRASP\_MODELS\_DIR*
	Hands, objects and scenarios are looked for here first.

*REGRASP\_GRAPHICS*
	How *plot --show* draws in the terminal: _auto_ (also when it is not set), _kitty_, _sixel_, _blocks_ or _dots_.

*NO\_COLOR*
	No colour, when it is not empty.

# FILES

What is cheap to make again replaces a file of its name: *plot -o*, *shape -o*, *param save* and
*checkpoint save*, which says so. What holds a run or took long refuses a name that is taken:
*record start*, *export*, *video*, *hand new*.

_$XDG\_RUNTIME\_DIR/regrasp/regrasp.sock_, _/run/regrasp/regrasp.sock_, _/tmp/regrasp-UID/regrasp.sock_
	The socket: the first that is there.

_$XDG\_CONFIG\_HOME/regrasp/regraspd.toml_, _/etc/regrasp/regraspd.toml_
	The configuration, see *regraspd*(8). *XDG\_CONFIG\_HOME* is _~/.config_ where it is not set.

_$XDG\_STATE\_HOME/regrasp_
	What the daemon writes (_/tmp/regrasp-UID/output_ for users without a home), and the shell's
	_history_. *XDG\_STATE\_HOME* is _~/.local/state_ where it is not set.

_$TMPDIR/regrasp-private-XXXXXX_
	Of private daemons, while they run; _/tmp_ where *TMPDIR* is not set or too long for a socket.

# SEE ALSO

*regraspd*(8), *regrasp-protocol*(7)
)";

}  // namespace

std::string ManualSource() {
  std::string page = kBeginning + Examples("") + kDescription;
  for (const Arg& arg : GlobalArgs()) page += Definition(arg);
  page += "# COMMANDS\n\n";
  for (const CommandSpec& command : Commands()) page += Section(command);
  page += "# EXIT STATUS\n\n";
  for (const ExitInfo& info : ExitTable())
    page += fmt::format("*{}*\n\t{}.\n\n", static_cast<int>(info.code),
                        Escaped(std::string(info.sentence)));
  return page + kEnd;
}

}  // namespace regrasp::cli
