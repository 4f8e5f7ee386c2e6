// Tools: what needs no daemon, and the raw wire.

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "cli/context.h"
#include "cli/daemon_process.h"
#include "cli/help.h"
#include "core/protocol/socket_path.h"
#include "core/quality/evaluate_json.h"

namespace regrasp::cli {
namespace {

constexpr const char* kGroup = "Tools";
namespace fs = std::filesystem;

ExitCode Call(Context& context, const Invocation& invocation) {
  Json params = Json::object();
  if (invocation.Has("params")) {
    params = Json::parse(invocation.Text("params"), nullptr, false);
    if (!params.is_object()) {
      throw CliError(kUsage, fmt::format("'{}' is not a JSON object", invocation.Text("params")),
                     R"(regrasp call explore '{"finger": "ring"}')");
    }
  }
  const Json answer = context.client().Call(invocation.Text("method"), params);
  context.Print(answer, [&] {
    context.out().Line(answer.dump(2, ' ', false, Json::error_handler_t::replace));
  });
  return kOk;
}

ExitCode Evaluate(Context& context, const Invocation& invocation) {
  const std::string name = invocation.Text("file");
  const bool standard_input = name == "-";
  std::error_code error;
  if (!standard_input && !fs::exists(name, error)) {
    throw CliError(kNotFound, fmt::format("no file {}", name), "regrasp help evaluate");
  }
  if (!standard_input && fs::is_directory(name, error)) {
    throw CliError(kIo, name + " is a directory", "regrasp help evaluate");
  }
  std::ifstream file;
  if (!standard_input) file.open(name);
  std::istream& in = standard_input ? std::cin : file;
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && !in.eof()) {
    throw CliError(::access(name.c_str(), R_OK) == 0 ? kIo : kPermission,
                   fmt::format("cannot read {}", name), "ls -l " + name);
  }
  Json answer;
  try {
    answer = Json::parse(EvaluateJson(text));
  } catch (const std::invalid_argument& failure) {
    throw CliError(kUsage,
                   fmt::format("{}: {}", standard_input ? "standard input" : name, failure.what()),
                   "regrasp help evaluate");
  }
  context.Print(answer, [&] {
    for (const auto& [key, value] : answer.items())
      context.out().Line(fmt::format("{:<22}{}", key, Plain(value)));
  });
  return kOk;
}

ExitCode Version(Context& context, const Invocation&) {
  Json answer = {{"version", REGRASP_VERSION}, {"protocol", kWireVersion}};
  if (context.options().verbose)
    answer["daemon"] = context.client().Call("version", Json::object());
  context.Print(answer, [&] {
    context.out().Line(fmt::format("regrasp {}", REGRASP_VERSION));
    if (context.options().verbose)
      context.out().Line(fmt::format("regraspd {}", Plain(At(answer["daemon"], "version"))));
  });
  return kOk;
}

ExitCode Help(Context& context, const Invocation& invocation) {
  std::string topic = invocation.Text("topic");
  if (invocation.Has("word")) topic += " " + invocation.Text("word");
  const std::string text = HelpText(topic, context.out());
  if (context.options().json) {
    Json commands = Json::array();
    for (const auto* command : FindCommands(topic)) {
      Json args = Json::array();
      for (const auto& arg : command->args) {
        args.push_back({{"key", arg.key},
                        {"flags", arg.flags},
                        {"metavar", arg.metavar},
                        {"required", arg.required},
                        {"help", arg.help}});
      }
      commands.push_back(
          {{"words", command->words},
           {"group", command->group},
           {"sentence", command->sentence},
           {"method", command->method == nullptr ? Json() : Json(command->method->name)},
           {"args", args}});
    }
    context.out().AddJson({{"commands", commands}});
  } else {
    context.out().Add(text);
  }
  return kOk;
}

ExitCode Completion(Context& context, const Invocation& invocation) {
  context.out().Add(CompletionScript(invocation.Text("shell")));
  return kOk;
}

struct Check {
  std::string name, finding, next;
  bool good;
};

Check CheckDaemonProgram() {
  std::string daemon;
  try {
    daemon = FindDaemon();
  } catch (const CliError& error) {
    return {"regraspd", error.what(), "build it, or install the package", false};
  }
  // Running it also finds every shared library it needs.
  std::string text = daemon;
  std::string command = "'" + daemon + "' --version 2>&1";
  if (FILE* pipe = ::popen(command.c_str(), "r")) {
    char line[512];
    if (std::fgets(line, sizeof line, pipe) != nullptr) text = line;
    const int status = ::pclose(pipe);
    while (!text.empty() && text.back() == '\n') text.pop_back();
    if (status == 0) return {"regraspd", text + " (" + daemon + ")", "", true};
  }
  return {"regraspd", text, "./check installs the packages it needs (packages.txt)", false};
}

Check CheckSocket(const std::string& flag) {
  const SocketPath socket = ResolveSocketPath(flag, "", SocketUse::kConnect);
  const std::string cause = DistrustedDirectory(socket.path);
  const std::string text = fmt::format("{} (from {})", socket.path, socket.source);
  if (!cause.empty()) return {"socket", text + ": " + cause, "choose another with -s", false};
  return {"socket", text, "", true};
}

Check CheckDaemon(Context& context) {
  try {
    const Json status = context.client().Call("status", Json::object());
    const std::string version = Plain(At(status, "version"));
    if (version != REGRASP_VERSION) {
      return {"daemon", fmt::format("version {}, this is {}", version, REGRASP_VERSION),
              "regrasp down, then regrasp up", false};
    }
    return {"daemon", fmt::format("answers, state {}", Plain(At(status, "state"))), "", true};
  } catch (const CliError& error) {
    // Not running is a state, not a fault.
    return {"daemon", error.what(), error.hint, error.code == kNoDaemon};
  }
}

Check CheckModels() {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& place : {program / "../share/regrasp/models", program / "../../../models",
                                fs::path(REGRASP_MODELS_DIR)}) {
    if (fs::is_directory(place / "hands", ignored))
      return {"models", fs::canonical(place, ignored).string(), "", true};
  }
  return {"models", "no folder of models found", "regrasp up --models-dir DIR", false};
}

ExitCode Doctor(Context& context, const Invocation&) {
  const std::vector<Check> checks = {CheckDaemonProgram(), CheckModels(),
                                     CheckSocket(context.options().socket), CheckDaemon(context)};
  Json answer = {{"ok", true}, {"checks", Json::array()}};
  for (const auto& check : checks) {
    answer["checks"].push_back({{"name", check.name},
                                {"ok", check.good},
                                {"finding", check.finding},
                                {"next", check.next}});
    if (!check.good) answer["ok"] = false;
  }
  context.Print(answer, [&] {
    Output& out = context.out();
    for (const auto& check : checks) {
      out.Line(
          fmt::format("{} {:<9}{}",
                      check.good ? out.Paint("ok  ", Style::kGood) : out.Paint("FAIL", Style::kBad),
                      check.name, check.finding));
      if (!check.next.empty()) out.Line("              try: " + check.next);
    }
  });
  return answer["ok"] == true ? kOk : kFailed;
}

}  // namespace

std::vector<CommandSpec> ToolCommands() {
  return {
      {"evaluate",
       kGroup,
       "quality measures of a grasp given as JSON; needs no daemon",
       nullptr,
       {{.key = "file",
         .flags = "",
         .metavar = "FILE",
         .help =
             R"({"contacts": [{"position_m": [3], "normal": [3] inward, "mu": x}], "torque_scale_m": r, "cone_edges": m, "weight_n": [3]}; - reads standard input)",
         .required = true}},
       Evaluate},
      {"call",
       kGroup,
       "send any method of the wire and print its answer",
       nullptr,
       {{.key = "method",
         .flags = "",
         .metavar = "METHOD",
         .help = "for example describe",
         .required = true},
        {.key = "params", .flags = "", .metavar = "JSON", .help = "its parameters, an object"}},
       Call},
      {"doctor", kGroup, "check program, models, socket and daemon", nullptr, {}, Doctor},
      {"completion",
       kGroup,
       "a completion script: eval \"$(regrasp completion bash)\"",
       nullptr,
       {{.key = "shell",
         .flags = "",
         .metavar = "SHELL",
         .help = "the shell",
         .values = {"bash", "zsh", "fish"},
         .required = true}},
       Completion},
      {"version",
       kGroup,
       "version of this program; with -v also of the daemon",
       nullptr,
       {},
       Version},
      {"help",
       kGroup,
       "this list, or help on a command",
       nullptr,
       {{.key = "topic", .flags = "", .metavar = "COMMAND", .help = "a command"},
        {.key = "word", .flags = "", .metavar = "WORD", .help = "its second word: help noise set"}},
       Help},
  };
}

}  // namespace regrasp::cli
