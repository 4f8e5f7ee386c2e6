// Tools: the configuration of the daemon. regraspd reads and checks it; here it is only shown.

#include <fmt/format.h>

#include "cli/client/context.h"
#include "cli/client/daemon_process.h"
#include "core/protocol/config_path.h"

namespace regrasp::cli {
namespace {

constexpr const char* kGroup = "Tools";

/// What `regraspd --config FILE OPTION` prints. Throws its error as ours.
std::string Ask(const std::string& file, const char* option) {
  const std::vector<std::string> words = {"--config", file};
  return AskDaemonProgram(file.empty() ? std::vector<std::string>() : words, option,
                          "regraspd --print-default-config");
}

/// As TOML writes it.
std::string Toml(const Json& value) {
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const auto& item : value) text += (text.empty() ? "" : ", ") + item.dump();
  return "[" + text + "]";
}

ExitCode Show(Context& context, const Invocation& invocation) {
  Json answer = Json::parse(Ask(invocation.Text("config"), "--print-config"));
  const bool origin = invocation.Has("origin"), all = context.options().verbose;
  std::vector<Json> rows;
  for (const char* part : {"keys", "parameters"})
    for (const auto& entry : answer[part])
      rows.push_back(
          {{"name", entry["name"]}, {"value", Toml(entry["value"])}, {"origin", entry["origin"]}});
  context.PrintRows(answer, rows, [&] {
    Output& out = context.out();
    const auto line = [&](const Json& entry, const std::string& name) {
      const std::string text = fmt::format("{} = {}", name, Toml(entry["value"]));
      out.Line(origin ? fmt::format("{:<32} # {}", text, Plain(entry["origin"])) : text);
    };
    out.Line(answer["file"].is_null() ? "# no configuration file" : "# " + Plain(answer["file"]));
    for (const auto& entry : answer["keys"]) line(entry, Plain(entry["name"]));
    std::string title = "\n[parameters]";
    for (const auto& entry : answer["parameters"]) {
      const bool set = entry["origin"] != "built in" && entry["origin"] != "model";
      if ((!set && !all) || entry["value"].is_null()) continue;
      if (!title.empty()) out.Line(std::exchange(title, ""));
      line(entry, fmt::format("\"{}\"", Plain(entry["name"])));
    }
  });
  return kOk;
}

ExitCode Check(Context& context, const Invocation& invocation) {
  Ask(invocation.Text("file"), "--check-config");
  const std::string file = invocation.Has("file") ? invocation.Text("file") : UsualConfigFile();
  context.Print({{"ok", true}, {"file", file.empty() ? Json() : Json(file)}}, [&] {
    context.out().Line(file.empty() ? "no configuration file; built in values and models are fine"
                                    : file + " is fine, and so are the models");
  });
  return kOk;
}

}  // namespace

std::vector<CommandSpec> ConfigCommands() {
  return {{"config show",
           kGroup,
           "the configuration a daemon started now would have",
           nullptr,
           {{.key = "origin",
             .flags = "--origin",
             .metavar = "",
             .kind = ArgKind::kFlag,
             .help = "and where each value comes from"},
            {.key = "config",
             .flags = "--config",
             .metavar = "FILE",
             .help = "with this file",
             .default_text = "the usual one, see regraspd(8)"}},
           Show},
          {"config check",
           kGroup,
           "check a configuration file, and the models it names",
           nullptr,
           {{.key = "file",
             .flags = "",
             .metavar = "FILE",
             .help = "the file (TOML)",
             .default_text = "the usual one, see regraspd(8)"}},
           Check}};
}

}  // namespace regrasp::cli
