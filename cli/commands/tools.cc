// Tools: what needs no daemon, and the raw wire.

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "cli/client/context.h"
#include "cli/commands/bench.h"
#include "cli/commands/doctor.h"
#include "cli/help/examples.h"
#include "cli/help/help.h"
#include "cli/help/manual.h"
#include "cli/shell/shell.h"
#include "core/files/json_text.h"
#include "core/files/names.h"
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
  context.Print(answer, [&] { context.out().Line(JsonText(answer, 2)); });
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
    throw CliError::List(
        kUsage,
        fmt::format("{}: {}", standard_input ? "standard input" : ShownText(name), failure.what()),
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
  if (invocation.Has("manual")) {
    context.out().Add(ManualSource());
    return kOk;
  }
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
      Json examples = Json::array();
      for (const auto& example : ExamplesOf(command->words))
        examples.push_back({{"line", example.line}, {"meaning", example.meaning}});
      commands.push_back(
          {{"words", command->words},
           {"group", command->group},
           {"sentence", command->sentence},
           {"method", command->method == nullptr ? Json() : Json(command->method->name)},
           {"examples", examples},
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
             R"({"contacts": [{"position_m": [3], "normal": [3] inward, "mu": x, "torsional_mu": y}], "normals": "outward", "torque_scale_m": r, "cone_edges": m, "weight_n": [3], "max_force_n": f}, most may be left out; or what contacts --json prints; - reads standard input. load_margin_unbounded: without max_force_n a force-closure grasp bears every load)",
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
      {"shell",
       kGroup,
       "commands one after the other: typed, from FILE, or from standard input",
       nullptr,
       {{.key = "file",
         .flags = "",
         .metavar = "FILE",
         .help = "a command a line, # begins a comment; stops at the first that fails"},
        {.key = "keep_going",
         .flags = "--keep-going",
         .metavar = "",
         .kind = ArgKind::kFlag,
         .help = "go on after a failure; the first one's exit code is the exit code"}},
       Shell},
      {"doctor", kGroup, "check program, models, physics, socket and daemon", nullptr, {}, Doctor},
      {"bench",
       kGroup,
       "measure what a tick and a request cost on this machine",
       nullptr,
       {{.key = "seconds",
         .flags = "--seconds",
         .metavar = "S",
         .kind = ArgKind::kNumber,
         .help = "wall clock of each of its four parts",
         .min = 0.01,
         .max = 3600,
         .default_text = "2"}},
       Bench},
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
        {.key = "word", .flags = "", .metavar = "WORD", .help = "its second word: help noise set"},
        {.key = "manual",
         .flags = "--manual",
         .metavar = "",
         .kind = ArgKind::kFlag,
         .help = "the source of regrasp(1), for scdoc"}},
       Help},
  };
}

}  // namespace regrasp::cli
