#pragma once

/// The command line as data. What a wire method knows (parameters, types, units, ranges, sentences)
/// comes from its table; a command adds which parameters are positional and what belongs to the
/// command line alone. Parsing, help and completion are made from the same list.

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/client/client.h"
#include "core/protocol/errors.h"
#include "core/protocol/methods.h"

namespace regrasp::cli {

class Context;

enum class ArgKind { kFlag, kText, kNumber, kInteger, kVector3, kParameterValue };

/// One argument of a command.
struct Arg {
  std::string key;        ///< name on the wire, or a name of our own
  std::string flags;      ///< "--angle", "-o,--output"; empty for a positional one
  std::string metavar;    ///< "DEG", "FINGER"; empty for a flag
  std::string unit = {};  ///< of the numbers of a vector, or of one: "MM"; empty where the
                          ///< metavar or the key names it
  ArgKind kind = ArgKind::kText;
  std::string help;
  double scale = 1;                      ///< value on the wire (SI) = typed value * scale
  double min = -1e300, max = 1e300;      ///< of the value on the wire, inclusive
  std::vector<std::string> values = {};  ///< the allowed words; empty: any
  std::string default_text = {};
  bool required = false;
  bool wire = false;      ///< goes into the parameters of the method
  bool repeated = false;  ///< may be given several times; the text has a line for each
};

/// What the user asked for.
struct Invocation {
  const struct CommandSpec* command = nullptr;
  Json params;                                    ///< of the method, in SI units; an object
  std::map<std::string, std::string> local = {};  ///< those not on the wire, as typed; no units
  bool Has(const std::string& key) const { return local.contains(key); }
  std::string Text(const std::string& key, const std::string& otherwise = "") const {
    return Has(key) ? local.at(key) : otherwise;
  }
};

using Handler = ExitCode (*)(Context&, const Invocation&);

struct CommandSpec {
  std::string words;  ///< "noise set"
  std::string group;  ///< heading in the help
  std::string sentence;
  const MethodSpec* method = nullptr;  ///< null for commands that are no single method
  std::vector<Arg> args = {};
  Handler run = nullptr;
};

/// An argument with a value, as it is typed.
Arg TextArg(std::string key, std::string flags, std::string metavar, std::string help,
            std::string default_text = "");

/// A command that sends `method`, its arguments made from the table. `positional`: parameters
/// without
/// `--`; `hidden`: parameters that this command does not offer; `extra`: arguments of its own.
struct MethodArguments {
  std::vector<std::string_view> positional = {};
  std::vector<std::string_view> hidden = {};
  std::vector<Arg> extra = {};
};
CommandSpec MethodCommand(std::string_view method, std::string group, Handler run,
                          const MethodArguments& arguments = {});
/// --wait, for commands that start a job.
Arg WaitFlag();

/// Every command, in the order of the help. Each commands_*.cc gives its group.
const std::vector<CommandSpec>& Commands();
std::vector<CommandSpec> RunCommands();
std::vector<CommandSpec> ControlCommands();
std::vector<CommandSpec> InspectCommands();
std::vector<CommandSpec> ResultCommands();
std::vector<CommandSpec> ExperimentCommands();
std::vector<CommandSpec> ToolCommands();
std::vector<CommandSpec> ConfigCommands();

/// Commands whose words begin with `words` ("noise" -> noise show, noise set …); exact match first.
std::vector<const CommandSpec*> FindCommands(std::string_view words);

enum class ColorMode { kAuto, kAlways, kNever };

struct GlobalOptions {
  std::string socket;  ///< -s; empty: the rule of core/protocol/socket_path.h
  bool json = false, csv = false, quiet = false, verbose = false;
  ColorMode color = ColorMode::kAuto;
  std::optional<double> timeout_s;  ///< --timeout
};

/// Reads the arguments; `options` holds the defaults and takes what the arguments say. Throws
/// CliError(kUsage) that names the argument and the nearest name. A request for help becomes an
/// invocation of `help`, no command at all on a terminal one of `shell`.
Invocation Parse(int argc, const char* const* argv, GlobalOptions* options);

/// Whether `--json` is among the arguments: for errors that come before they are understood.
bool WantsJson(int argc, const char* const* argv);

/// The global options, for help and completion.
std::span<const Arg> GlobalArgs();

/// `text` as a number, finite, nothing left over. Throws CliError(kUsage) that names `what`.
double ParseNumber(const std::string& text, const std::string& what);
/// "X,Y,Z" as numbers, `count` of them.
/// What the daemon takes for a parameter: a finite number, three of them with commas between, true
/// or false; anything else goes as a word, which the daemon judges.
Json ParseParameterValue(const std::string& text);
std::vector<double> ParseNumbers(const std::string& text, std::size_t count,
                                 const std::string& what);

}  // namespace regrasp::cli
