// Run: the private daemon.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "cli/client/config_file.h"
#include "cli/client/context.h"
#include "cli/client/daemon_process.h"
#include "cli/demo/demo.h"
#include "core/protocol/socket_path.h"

namespace regrasp::cli {
namespace {

constexpr const char* kHelp = "regrasp help up";
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
      arg("clock", "MODE", "continuous, or lockstep: time advances only while a job runs",
          "lockstep with --speed max, else continuous"),
      arg("seed", "N", "seed of the run", "1"),
      arg("hand", "NAME|FILE", "hand model"),
      arg("object", "NAME|FILE", "object model"),
      arg("noise", "PRESET", "sensor noise", "paper"),
      arg("stepper", "NAME", "fast, exact (slow reference), round (fast, friction cone), or auto",
          "auto"),
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
    const bool path = arg.key.ends_with("-dir") || arg.key == "config" ||
                      value.find('/') != std::string::npos || value.ends_with(".urdf") ||
                      value.ends_with(".toml");
    words.push_back(path ? std::filesystem::absolute(value).string() : value);
  }
  return words;
}

/// What the options of this call, file and environment make of every key: {KEY: {value, origin}}.
Json Resolve(const std::vector<std::string>& words) {
  Json keys;
  const Json config = Json::parse(AskDaemonProgram(words, "--print-config", kHelp));
  for (const Json& key : config.at("keys")) keys[Plain(key.at("name"))] = key;
  return keys;
}

/// Where the options of this call differ from what runs: "seed is 1, not 4; ...".
std::string Differences(const Json& wanted, const Invocation& invocation, const Json& status) {
  std::string text;
  for (const auto& [flag, key] :
       {std::pair{"seed", "seed"}, std::pair{"hand", "hand"}, std::pair{"object", "object"},
        std::pair{"noise", "noise"}, std::pair{"speed", "speed"}, std::pair{"clock", "clock"},
        std::pair{"paused", "paused"}, std::pair{"output-dir", "output_dir"}}) {
    if (!invocation.Has(flag)) continue;
    Json is = At(status, key), want = wanted.at(key).at("value");
    if (is.is_object()) is = At(is, "preset");
    if (want.is_string() &&
        (want.get<std::string>().ends_with(".urdf") || want.get<std::string>().ends_with(".toml")))
      want = std::filesystem::path(want.get<std::string>()).stem().string();
    if (is != want)
      text +=
          fmt::format("{}{} is {}, not {}", text.empty() ? "" : "; ", flag, Plain(is), Plain(want));
  }
  return text;
}

/// "process 123", as the daemon's lock file tells.
std::string HolderOf(const std::string& socket) {
  std::ifstream lock(socket + ".lock");
  long pid = 0;
  return lock >> pid && pid > 0 ? fmt::format("process {}", pid) : "a daemon";
}

/// Whether a daemon answers on `socket`; one that is about to begin or to end is waited for.
bool Running(const std::string& socket, double timeout_s) {
  constexpr double kSlice_s = 0.05;
  for (const auto deadline = Deadline(timeout_s);;) {
    if (Listening(socket)) return true;
    if (WaitForLock(socket, kSlice_s)) return false;
    if (Clock::now() > deadline)
      throw CliError(kTimeout,
                     fmt::format("{} holds {}.lock but does not answer after {:g} s",
                                 HolderOf(socket), socket, timeout_s),
                     "kill that process, then regrasp up");
  }
}

/// Throws CliError(kRefused) unless what runs is what the options ask for.
void CheckSame(const Invocation& invocation, const std::vector<std::string>& words,
               const Json& wanted, const std::string& socket, const Json& status) {
  if (words.empty()) return;
  AskDaemonProgram(words, "--check-config", kHelp);
  const std::string differences = Differences(wanted, invocation, status);
  if (!differences.empty())
    throw CliError(kRefused,
                   fmt::format("a daemon is already running on {}: {}", socket, differences),
                   "regrasp down, then regrasp up");
}

ExitCode Up(Context& context, const Invocation& invocation) {
  const Interruptible interruptible;
  const std::string socket =
      ResolveSocketPath(context.options().socket, ConfiguredSocket(), SocketUse::kListen).path;
  const auto words = DaemonWords(invocation);
  const Json wanted = Resolve(words);
  const bool running = Running(socket, context.timeout_s());
  Json answer = {{"started", !running}, {"socket", socket}};
  if (!running) {
    auto arguments = words;
    if (At(wanted.at("speed"), "value") == "max" && At(wanted.at("clock"), "origin") == "built in")
      arguments.insert(arguments.end(), {"--clock", "lockstep"});
    const StartedDaemon started = StartDaemon(socket, arguments, context.timeout_s());
    answer["pid"] = started.pid;
    answer["log"] = started.log;
  }
  Client client(socket, context.timeout_s());
  const Json status = client.Call("status", Json::object());
  if (running) CheckSame(invocation, words, wanted, socket, status);
  for (const char* key : {"version", "hand", "object", "clock", "warnings"})
    answer[key] = At(status, key);
  context.Print(answer, [&] {
    Output& out = context.out();
    out.Line(fmt::format("regraspd {} {} on {}", Plain(answer["version"]),
                         running ? "is already running" : "is ready", socket));
    out.Line(fmt::format("  hand {}, object {}, {} clock", Plain(answer["hand"]),
                         Plain(answer["object"]), Plain(answer["clock"])));
    for (const Json& warning : answer["warnings"]) out.Line("  warning: " + Plain(warning));
    if (!running)
      out.Line(fmt::format("  pid {}, log {}", Plain(answer["pid"]), Plain(answer["log"])));
  });
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
