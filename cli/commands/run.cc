// Run: the private daemon.

#include <fmt/format.h>

#include <filesystem>

#include "cli/client/config_file.h"
#include "cli/client/context.h"
#include "cli/client/daemon_process.h"
#include "cli/demo/demo.h"
#include "core/protocol/socket_path.h"

namespace regrasp::cli {
namespace {

constexpr const char* kGroup = "Run";

/// Options that go to the daemon as they are.
std::vector<Arg> DaemonArgs() {
  const auto arg = [](const char* key, const char* metavar, const char* help,
                      const char* default_text = "") {
    return Arg{.key = key,
               .flags = std::string("--") + key,
               .metavar = metavar,
               .help = help,
               .default_text = default_text};
  };
  const auto flag = [](const char* key, const char* help) {
    return Arg{.key = key,
               .flags = std::string("--") + key,
               .metavar = "",
               .kind = ArgKind::kFlag,
               .help = help};
  };
  return {
      arg("speed", "X", "times real time, or max", "1"),
      arg("seed", "N", "seed of the run", "1"),
      arg("hand", "NAME|FILE", "hand model"),
      arg("object", "NAME|FILE", "object model"),
      arg("noise", "PRESET", "sensor noise", "paper"),
      flag("paused", "begin with the clock stopped"),
      arg("models-dir", "DIR", "where models are looked for first"),
      flag("inertia-from-shape", "compute the object's centre and inertia from its shape"),
      flag("force", "take an object that cannot exist"),
      flag("fill-missing-meshes", "a capsule where a hand's mesh file is not there"),
      arg("output-dir", "DIR", "where pictures and records are written"),
      arg("config", "FILE", "configuration of the daemon (TOML)"),
  };
}

std::vector<std::string> DaemonWords(const Invocation& invocation) {
  std::vector<std::string> words;
  for (const auto& arg : invocation.command->args) {
    if (!invocation.Has(arg.key)) continue;
    words.push_back(arg.flags);
    if (arg.kind == ArgKind::kFlag) continue;
    std::string value = invocation.Text(arg.key);
    const bool path =
        arg.key.ends_with("-dir") || arg.key == "config" || value.find('/') != std::string::npos;
    words.push_back(path ? std::filesystem::absolute(value).string() : value);
  }
  return words;
}

ExitCode Up(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const std::string socket =
      ResolveSocketPath(context.options().socket, ConfiguredSocket(), SocketUse::kListen).path;
  const auto words = DaemonWords(invocation);
  const bool running = Listening(socket);
  Json answer = {{"started", !running}, {"socket", socket}};
  if (!running) {
    const StartedDaemon started = StartDaemon(socket, words, context.timeout_s());
    answer["pid"] = started.pid;
    answer["log"] = started.log;
  }
  Client client(socket, context.timeout_s());
  const Json status = client.Call("status", Json::object());
  for (const char* key : {"version", "hand", "object"}) answer[key] = At(status, key);
  context.Print(answer, [&] {
    Output& out = context.out();
    out.Line(fmt::format("regraspd {} {} on {}", Plain(answer["version"]),
                         running ? "is already running" : "is ready", socket));
    out.Line(fmt::format("  hand {}, object {}", Plain(answer["hand"]), Plain(answer["object"])));
    if (!running)
      out.Line(fmt::format("  pid {}, log {}", Plain(answer["pid"]), Plain(answer["log"])));
  });
  if (running && !words.empty()) {
    fmt::print(stderr,
               "regrasp: it was running already: the options of this call change nothing\n  try: "
               "regrasp down, then regrasp up again\n");
  }
  return kOk;
}

ExitCode Down(Context& context, const Invocation&) {
  const Interruptible interruptible;
  const std::string socket = ClientSocket(context.options().socket);
  const bool activated = StopDaemon(socket, context.timeout_s());
  context.Print({{"stopped", true}, {"socket", socket}, {"activated", activated}}, [&] {
    context.out().Line("regraspd on " + socket + " has stopped");
    if (activated)
      context.out().Line(
          "  the next command starts it again; systemctl stop regraspd.socket ends that");
  });
  return kOk;
}

}  // namespace

std::vector<CommandSpec> RunCommands() {
  return {
      {"up", kGroup, "start a private daemon in the background and wait until it is ready", nullptr,
       DaemonArgs(), Up},
      {"down", kGroup, "stop it cleanly", nullptr, {}, Down},
      {"demo",
       kGroup,
       "grasp, explore, rotate, pictures, and the paper's claims against this run",
       nullptr,
       {{.key = "output",
         .flags = "-o,--output",
         .metavar = "DIR",
         .help = "where the pictures go",
         .default_text = "regrasp-demo"},
        {.key = "seed",
         .flags = "--seed",
         .metavar = "N",
         .kind = ArgKind::kInteger,
         .help = "seed of the runs",
         .min = 0,
         .max = kMaxSafeInteger,
         .default_text = "1"},
        {.key = "repeats",
         .flags = "--repeats",
         .metavar = "N",
         .kind = ArgKind::kInteger,
         .help = "explorations of figure 2 with other start gradients (the paper: 50)",
         .min = 0,
         .max = 1000,
         .default_text = "10"},
        {.key = "models-dir",
         .flags = "--models-dir",
         .metavar = "DIR",
         .help = "where models are looked for first"}},
       Demo},
  };
}

}  // namespace regrasp::cli
