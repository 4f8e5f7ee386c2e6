#include "cli/commands/doctor.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "cli/client/daemon_process.h"
#include "cli/client/errors.h"
#include "cli/client/private_daemon.h"
#include "cli/client/program.h"
#include "core/files/output_file.h"
#include "core/protocol/user_directories.h"

namespace regrasp::cli {
namespace {

namespace fs = std::filesystem;

struct Check {
  std::string name, finding, next;
  bool good = true;
};

std::string FirstLine(const Finished& finished) {
  const std::string& text = finished.code == 0 ? finished.out : finished.err;
  std::string line = text.substr(0, text.find('\n'));
  if (line.starts_with("regraspd: ")) line.erase(0, 10);
  return line;
}

/// `error` as a finding. An interrupt is none: it ends the examination.
Check Fault(const std::string& name, const CliError& error, std::string next) {
  if (error.code == kInterrupted) throw error;
  return {name, error.what(), std::move(next), false};
}

/// What to try after an error here, where some recommend this very command.
std::string NextAfter(const CliError& error) {
  if (error.hint.find("regrasp doctor") == std::string::npos) return error.hint;
  if (error.code == kTimeout) return "ps -C regraspd -o pid,stat,args    (T: stopped; kill -CONT)";
  if (error.code == kProtocol) return "regrasp -s OTHER_PATH up    (another program listens there)";
  return "";
}

/// Running it also finds every shared library it needs.
Check CheckProgram(const std::string& daemon) {
  const Finished finished = RunProgram({daemon, "--version"});
  if (finished.code == 0) return {"program", FirstLine(finished) + ", " + daemon, ""};
  return {"program", FirstLine(finished), "./check installs the packages it needs (packages.txt)",
          false};
}

/// The programs that replay, film and draw. Without arguments each says how it is used.
Check CheckHelpers() {
  std::string found;
  for (const char* name : {"regrasp-run", "regrasp-film", "regrasp-hand", "regrasp-object",
                           "regrasp-plot-experiment"}) {
    try {
      const std::string path = FindHelper(name);
      const Finished finished = RunProgram({path});
      if (finished.code != static_cast<int>(kUsage))
        return {"helpers", FirstLine(finished),
                "./check installs the packages it needs (packages.txt)", false};
    } catch (const CliError& error) {
      return Fault("helpers", error, "build everything, or install the package");
    }
    found += (found.empty() ? "" : ", ") + std::string(name);
  }
  return {"helpers", found, ""};
}

Check CheckFont() {
  for (const char* place : {"/usr/share/fonts/truetype/dejavu", "/usr/share/fonts/dejavu"})
    if (fs::exists(fs::path(place) / "DejaVuSans.ttf")) return {"font", place, ""};
  return {"font", "DejaVu Sans is missing: no pictures", "apt install fonts-dejavu-core", false};
}

/// Reads the configuration, loads the models it names and builds the session.
Check CheckConfiguration(const std::string& daemon) {
  const Finished finished = RunProgram({daemon, "--check-config"});
  if (finished.code == 0) return {"models", "hand, object and configuration load", ""};
  const bool model =
      finished.code == static_cast<int>(kNotFound) || finished.code == static_cast<int>(kFailed);
  return {"models", FirstLine(finished),
          model ? "regrasp up --models-dir DIR" : "regrasp config check", false};
}

/// What a key of the configuration is; empty where that cannot be told.
std::string Configured(const std::string& daemon, const char* name) {
  const Json config = Json::parse(RunProgram({daemon, "--print-config"}).out, nullptr, false);
  if (config.is_object())
    for (const auto& key : config["keys"])
      if (key["name"] == name) return Plain(key["value"]);
  return "";
}

/// The step that the configured hand gets, tried on the hand itself.
Check CheckStepper(const std::string& daemon) {
  const std::string hand = Configured(daemon, "hand"), set = Configured(daemon, "stepper");
  try {
    const Finished finished =
        RunProgram({FindHelper("regrasp-hand"), "check", hand.empty() ? "shadow" : hand, "--json"});
    const bool good = finished.code == 0;
    const std::string& answer = finished.out.empty() ? finished.err : finished.out;
    const Json told = Json::parse(answer, nullptr, false);
    if (!good || !told.is_object()) {
      const std::string cause = !told.is_object()        ? FirstLine(finished)
                                : told.contains("error") ? Plain(At(told["error"], "message"))
                                                         : Plain(At(told, "stepper_reason"));
      return {"stepper", cause, "regrasp hand check " + hand, false};
    }
    const std::string best = Plain(told["stepper"]);
    return {
        "stepper",
        fmt::format("{} for {}: {}{}", best, Plain(told["hand"]), Plain(told["stepper_reason"]),
                    set.empty() || set == "auto" || set == best ? "" : "; configured is " + set),
        ""};
  } catch (const CliError& error) {
    return Fault("stepper", error, error.hint);
  }
}

/// Where the daemon that answers writes; where none does, the one that would start.
Check CheckOutput(Context& context, const std::string& daemon) {
  std::string directory;
  try {
    directory = Plain(At(context.client().Call("status", Json::object()), "output_dir"));
  } catch (const CliError&) {  // CheckDaemon tells
    directory = Configured(daemon, "output_dir");
  }
  if (directory.empty()) directory = DefaultOutputDir();
  const std::string cause = WhyNoOutput(directory);
  if (cause.empty()) return {"output", directory, ""};
  return {"output", directory + ": " + cause, "regrasp up --output-dir DIR", false};
}

Check CheckSocket(const std::string& flag) {
  try {
    const SocketPath socket = ConnectPath(flag);
    const std::string text = fmt::format("{} (from {})", socket.path, socket.source);
    const std::string cause = DistrustedDirectory(socket.path);
    if (!cause.empty()) return {"socket", text + ": " + cause, "choose another with -s", false};
    return {"socket", text, ""};
  } catch (const CliError& error) {
    return Fault("socket", error, NextAfter(error));
  }
}

Check CheckDaemon(Context& context) {
  try {
    const Json status = context.client().Call("status", Json::object());
    const std::string version = Plain(At(status, "version"));
    if (version != REGRASP_VERSION)
      return {"daemon", fmt::format("version {}, this is {}", version, REGRASP_VERSION),
              "regrasp down, then regrasp up", false};
    return {"daemon", fmt::format("answers, state {}", Plain(At(status, "state"))), ""};
  } catch (const CliError& error) {
    Check check = Fault("daemon", error, NextAfter(error));
    check.good = error.code == kNoDaemon;  // not running is a state, not a fault
    return check;
  }
}

/// A private daemon grasps and holds for two simulated seconds, twice: the object must stay, and
/// the bits must be the same.
class SelfTest {
 public:
  explicit SelfTest(const std::string& socket) : client_(socket, 30) {}

  Check Run() {
    const std::string first = HoldTwoSeconds();
    if (!cause_.empty()) return {"physics", cause_, "regrasp up, then regrasp events", false};
    client_.Call("reset", {{"seed", 1}});
    if (HoldTwoSeconds() != first)
      return {"physics", "the same seed gave other bits: this machine computes unreliably",
              "memtest86+", false};
    return {
        "physics",
        fmt::format("held for 2 s, {:.3f} mm off its place, the same bits twice", moved_m_ * 1e3),
        ""};
  }

 private:
  static constexpr int kTicksToHold = 4000, kTicksHeld = 2000;
  static constexpr double kMostMoved = 1e-3;  // [m]: what the project promises for a hold

  void Step(int ticks) {
    const Json job = client_.Call("step", {{"ticks", ticks}});
    client_.Call("job.wait", {{"id", job["job"]}}, 60);
  }
  Json Position() { return client_.Call("truth", Json::object())["object"]["p_WO_m"]; }

  /// Returns the hash of the state at the end; `cause_` says what went wrong.
  std::string HoldTwoSeconds() {
    client_.Call("grasp", Json::object());
    Step(kTicksToHold);
    const Json before = Position();
    Step(kTicksHeld);
    const Json after = Position(), status = client_.Call("status", Json::object());
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double d = after[i].get<double>() - before[i].get<double>();
      square += d * d;
    }
    moved_m_ = std::sqrt(square);
    if (status["state"] != "holding")
      cause_ = "the hand did not hold the object: state " + Plain(status["state"]);
    else if (moved_m_ > kMostMoved)
      cause_ = fmt::format("the object moved by {:.2f} mm in 2 s", moved_m_ * 1e3);
    return Plain(status["state_hash"]);
  }

  Client client_;
  std::string cause_;
  double moved_m_ = 0;
};

Check CheckPhysics() {
  try {
    const PrivateDaemon daemon(
        {"--paused", "--speed", "max", "--seed", "1", "--noise", "paper", "--hand", "shadow"});
    return SelfTest(daemon.socket()).Run();
  } catch (const CliError& error) {
    return Fault("physics", error, NextAfter(error));
  }
}

}  // namespace

ExitCode Doctor(Context& context, const Invocation&) {
  const Interruptible interruptible;
  std::vector<Check> checks;
  try {
    const std::string daemon = FindDaemon();
    checks = {CheckProgram(daemon), CheckHelpers(),
              CheckFont(),          CheckConfiguration(daemon),
              CheckStepper(daemon), CheckOutput(context, daemon),
              CheckPhysics()};
  } catch (const CliError& error) {
    checks = {Fault("program", error, "build it, or install the package")};
  }
  checks.push_back(CheckSocket(context.options().socket));
  checks.push_back(CheckDaemon(context));
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
      if (!check.next.empty())
        out.Line("              try: " + AtSocket(check.next, context.options().socket));
    }
  });
  return answer["ok"] == true ? kOk : kFailed;
}

}  // namespace regrasp::cli
