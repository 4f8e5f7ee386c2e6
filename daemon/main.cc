// regraspd: the service. Arguments, environment and file become a DaemonConfig; the rest is Daemon.

#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "core/common/nearest_name.h"
#include "core/files/draft.h"
#include "core/files/json_text.h"
#include "core/files/names.h"
#include "core/files/output_file.h"
#include "core/hand/scenario.h"
#include "core/protocol/errors.h"
#include "core/protocol/standard_files.h"
#include "daemon/config/config.h"
#include "daemon/daemon.h"
#include "daemon/log_sink.h"
#include "daemon/loop/bench.h"
#include "daemon/pages/manual.h"
#include "daemon/pages/protocol_page.h"
#include "daemon/requests/service.h"
#include "daemon/server/memory_reserve.h"
#include "daemon/server/socket.h"
#include "daemon/wire/json.h"

namespace regrasp {
namespace {

/// One line, with the message as a JSON string.
class JsonMessage : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    const std::string text =
        JsonText(Json(std::string(message.payload.data(), message.payload.size())));
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JsonMessage>();
  }
};

void StartLog(const DaemonConfig& config) {
  auto logger = std::make_shared<spdlog::logger>("regraspd", std::make_shared<PatientSink>());
  logger->set_level(spdlog::level::from_str(config.log_level));
  if (config.log_format == "json") {
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<JsonMessage>('*').set_pattern(
        R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","message":%*})");
    logger->set_formatter(std::move(formatter));
  } else {
    logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
  }
  spdlog::set_default_logger(std::move(logger));
}

/// `cause`: a line or lines that may be shown as they are (ProblemList::Text).
int FailShown(const std::string& cause, const std::string& next, ExitCode code) {
  fmt::print(stderr, "regraspd: {}\n", cause);
  if (!next.empty()) fmt::print(stderr, "try: {}\n", next);
  return static_cast<int>(code);
}

int Fail(const std::string& cause, const std::string& next, ExitCode code) {
  return FailShown(ShownText(cause), next, code);
}

/// Puts the answer on standard output, to its last byte.
int Print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    return Fail(fmt::format("cannot write to standard output: {}", std::strerror(errno)),
                errno == ENOSPC ? "df -h .    (is the disk full?)" : "> FILE after the command",
                ExitCode::kIo);
  return static_cast<int>(ExitCode::kOk);
}

/// Values from the command line.
struct Flags {
  std::string config;
  std::vector<std::string> text;  ///< by index into ConfigKeys()
  double bench_s = 0;
  bool paused = false, check = false, print_default = false, print_config = false,
       print_protocol = false, print_manual = false, print_protocol_manual = false, version = false,
       until_eof = false;
};

constexpr const char* kDescription =
    R"(The service of regrasp: simulates the hand, runs its controller, answers on a Unix socket.

Examples:
  regraspd                                     in real time, until Ctrl-C
  regraspd --speed max --seed 7                as fast as it can
  regraspd --print-default-config > hand.toml  every key with its built-in value
  regraspd --config hand.toml --check-config   is the file right?

A flag beats the environment ($REGRASP_SEED for --seed), which beats the file.
)";

void AddFlags(CLI::App& app, Flags& f) {
  app.add_option("--config", f.config,
                 "configuration file (TOML); else $REGRASP_CONFIG, "
                 "~/.config/regrasp/regraspd.toml or /etc/regrasp/regraspd.toml")
      ->type_name("FILE.toml");
  f.text.resize(ConfigKeys().size());
  const DaemonConfig built_in;
  for (std::size_t i = 0; i < f.text.size(); ++i) {
    const ConfigKey& key = ConfigKeys()[i];
    const std::string value = key.get(built_in);
    if (key.kind == KeyKind::kBool)
      app.add_flag(FlagOf(key), f.paused, std::string(key.sentence));
    else
      app.add_option(FlagOf(key), f.text[i],
                     value.empty() ? std::string(key.sentence)
                                   : fmt::format("{} (default {})", key.sentence, value))
          ->type_name(std::string(key.metavar));
  }
  app.add_flag("--check-config", f.check, "check configuration and models, then exit");
  app.add_flag("--print-default-config", f.print_default, "print a configuration file, then exit");
  app.add_flag("--print-config", f.print_config,
               "print as JSON what is in force and where it comes from, then exit");
  app.add_flag("--print-protocol", f.print_protocol, "print the protocol page, then exit");
  app.add_flag("--print-protocol-manual", f.print_protocol_manual,
               "print the source of regrasp-protocol(7), then exit");
  app.add_flag("--print-manual", f.print_manual, "print the source of regraspd(8), then exit");
  app.add_flag("--until-eof", f.until_eof,
               "stop when standard input ends: with the program that holds its other end");
  app.add_option("--bench", f.bench_s,
                 "measure ticks for so long in each state, print JSON, then exit")
      ->type_name("S")
      ->check(CLI::Range(0.01, 3600.0));
  app.add_flag("--version", f.version, "print the version, then exit");
}

ConfigFlags Given(const CLI::App& app, const Flags& f) {
  ConfigFlags flags{f.config, {}};
  for (std::size_t i = 0; i < f.text.size(); ++i) {
    const ConfigKey& key = ConfigKeys()[i];
    if (app.count(FlagOf(key)) > 0)
      flags.set.emplace_back(key.name, key.kind == KeyKind::kBool ? "true" : f.text[i]);
  }
  return flags;
}

/// The first argument nobody wanted, and the flag it may have meant (the library names neither
/// well).
std::string Unexpected(const CLI::App& app) {
  const std::vector<std::string> extras = app.remaining();
  const auto flag =
      std::ranges::find_if(extras, [](const std::string& a) { return a.starts_with('-'); });
  const std::string argument = flag != extras.end() ? *flag : extras.front();
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) names.push_back(option->get_name());
  return fmt::format("unknown argument {}{}", argument, OrNearest(argument, names));
}

constexpr std::size_t kMemoryReserve = 4 << 20;  // [bytes]: a frame, its answers, a picture's start

/// As many descriptors as the clients and the daemon's own may need, where that is allowed.
void RaiseDescriptorLimit(int clients) {
  constexpr rlim_t kOwn = 32;
  const rlim_t wanted = static_cast<rlim_t>(clients) + kOwn;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted) return;
  limit.rlim_cur = std::min(wanted, limit.rlim_max);
  ::setrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur < wanted)
    spdlog::warn("{} descriptors are allowed: fewer clients than {} can connect", limit.rlim_cur,
                 clients);
}

int Serve(const DaemonConfig& config, const Daemon::ConfigSource& source, bool until_eof) {
  StartLog(config);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error, not the end
  KeepFromOthers();
  RaiseDescriptorLimit(config.max_clients);
  MemoryReserve::Install(kMemoryReserve);
  Daemon daemon(config);
  spdlog::info("regraspd {} listens on {}, configuration {}", Version(),
               ShownText(daemon.socket_path()),
               config.file.empty() ? "built in" : ShownText(config.file));
  if (until_eof) daemon.StopAtEndOf(STDIN_FILENO);
  daemon.Run(true, source);
  spdlog::info("stopped");
  return static_cast<int>(ExitCode::kOk);
}

int Main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (!IsUtf8(argv[i]))
      return Fail(fmt::format("argument {} is not UTF-8: {}", i, Shown(argv[i])), "regraspd --help",
                  ExitCode::kUsage);
  CLI::App app(kDescription, "regraspd");
  Flags flags;
  AddFlags(app, flags);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return Print(app.help());
  } catch (const CLI::ExtrasError& e) {
    return Fail(Unexpected(app), "regraspd --help", ExitCode::kUsage);
  } catch (const CLI::ParseError& e) {
    return Fail(e.what(), "regraspd --help", ExitCode::kUsage);
  }
  try {
    if (flags.version)
      return Print(fmt::format("regraspd {} (protocol {})\n", Version(), kWireVersion));
    if (flags.print_default) return Print(DefaultConfigText());
    if (flags.print_manual) return Print(DaemonManual());
    if (flags.print_protocol_manual) return Print(ProtocolManual());
    if (flags.print_protocol) return Print(ProtocolPage());
    const auto source = [given = Given(app, flags)] { return ResolveConfig(given); };
    const DaemonConfig config = source();
    if (flags.print_config) return Print(ConfigJson(config) + "\n");
    if (flags.bench_s != 0) return Print(Benchmark(config, flags.bench_s) + "\n");
    if (!flags.check) return Serve(config, source, flags.until_eof);
    for (const std::string& warning : CheckModels(config))
      fmt::print(stderr, "regraspd: warning: {}\n", warning);
    return Print("configuration ok\n");
  } catch (const ConfigNotFound& e) {
    return FailShown(e.what(), "regraspd --print-default-config", ExitCode::kNotFound);
  } catch (const ConfigError& e) {
    return FailShown(e.what(), "regraspd --print-default-config", ExitCode::kUsage);
  } catch (const ModelError& e) {
    return FailShown(e.what(), "regraspd --check-config",
                     e.names_no_model ? ExitCode::kNotFound : ExitCode::kFailed);
  } catch (const WriteError& e) {
    return FailShown(e.what(), "regraspd --output-dir DIR", ExitCode::kIo);
  } catch (const SocketError& e) {
    const bool busy = e.exit_code() == ExitCode::kRefused;
    return Fail(e.what(), busy ? "regrasp status" : "regraspd --socket PATH", e.exit_code());
  } catch (const std::exception& e) {
    return Fail(e.what(), "", ExitCode::kIo);
  }
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) {
  // Large blocks (pictures: 50 MB) go back to the system when they are freed. Left alone, glibc
  // takes them from the heap once it has seen a few, and whatever stands above keeps them there.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
  regrasp::OccupyStandardFiles();
  return regrasp::Main(argc, argv);
}
