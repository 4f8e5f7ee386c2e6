// regraspd: the service. Arguments, environment and file become a DaemonConfig; the rest is Daemon.

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "core/common/nearest_name.h"
#include "core/hand/scenario.h"
#include "core/protocol/errors.h"
#include "core/protocol/methods.h"
#include "daemon/config.h"
#include "daemon/daemon.h"
#include "daemon/json.h"
#include "daemon/protocol_page.h"
#include "daemon/service.h"
#include "daemon/socket.h"

namespace regrasp {
namespace {

/// One line, with the message as a JSON string.
class JsonMessage : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    const std::string text = Json(std::string(message.payload.data(), message.payload.size()))
                                 .dump(-1, ' ', false, Json::error_handler_t::replace);
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JsonMessage>();
  }
};

void StartLog(const DaemonConfig& config) {
  auto logger = spdlog::stderr_color_mt("regraspd");
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

int Fail(const std::string& cause, const std::string& next, ExitCode code) {
  fmt::print(stderr, "regraspd: {}\n", cause);
  if (!next.empty()) fmt::print(stderr, "try: {}\n", next);
  return static_cast<int>(code);
}

/// Values from the command line; empty: not given.
struct Flags {
  std::string config;
  std::optional<std::string> socket, output_dir, hand, object, models_dir, speed, noise, log_level,
      log_format, stepper;
  std::optional<std::int64_t> seed;
  std::optional<int> max_clients;
  bool paused = false, check = false, print_default = false, print_protocol = false,
       version = false;
};

void AddFlags(CLI::App& app, Flags& f) {
  app.add_option("--config", f.config, "configuration file (TOML)")->type_name("FILE.toml");
  app.add_option("--socket", f.socket, "where to listen [$REGRASP_SOCKET]")->type_name("PATH");
  app.add_option("--output-dir", f.output_dir, "where pictures go [$REGRASP_OUTPUT_DIR]")
      ->type_name("DIR");
  app.add_option("--seed", f.seed, "seed of the first run (default 1)")->type_name("N");
  app.add_option("--hand", f.hand, "the hand (default shadow)")->type_name("NAME|FILE.urdf");
  app.add_option("--object", f.object, "the object (default: the scenario's)")
      ->type_name("NAME|FILE.urdf");
  app.add_option("--models-dir", f.models_dir, "searched first for models [$REGRASP_MODELS_DIR]")
      ->type_name("DIR");
  app.add_option("--speed", f.speed, "times real time (default 1.0), or max")->type_name("X|max");
  app.add_flag("--paused", f.paused, "begin with the clock stopped");
  app.add_option("--noise", f.noise, "sensor noise (default paper)")->type_name("PRESET");
  app.add_option("--max-clients", f.max_clients, "connections at the same time (default 64)")
      ->type_name("N");
  app.add_option("--log-level", f.log_level, "trace, debug, info, warn, error, off")
      ->type_name("LEVEL");
  app.add_option("--log-format", f.log_format, "text or json, on stderr")->type_name("FORMAT");
  app.add_option("--stepper", f.stepper, "fast (default), or exact: the slow reference")
      ->type_name("NAME");
  app.add_flag("--check-config", f.check, "check configuration and models, then exit");
  app.add_flag("--print-default-config", f.print_default, "print a configuration file, then exit");
  app.add_flag("--print-protocol", f.print_protocol, "print the protocol page, then exit");
  app.add_flag("--version", f.version, "print the version, then exit");
}

/// Flag beats environment beats file.
DaemonConfig Resolve(const Flags& f) {
  DaemonConfig config;
  if (!f.config.empty()) ReadConfigFile(f.config, &config);
  const auto take = [](const std::optional<std::string>& flag, const char* variable,
                       std::string* value) {
    const char* set = variable ? std::getenv(variable) : nullptr;
    if (set && *set) *value = set;
    if (flag) *value = *flag;
  };
  take(f.socket, "REGRASP_SOCKET", &config.socket);
  take(f.output_dir, "REGRASP_OUTPUT_DIR", &config.output_dir);
  take(f.models_dir, "REGRASP_MODELS_DIR", &config.models_dir);
  take(f.hand, nullptr, &config.hand);
  take(f.object, nullptr, &config.object);
  take(f.speed, nullptr, &config.speed);
  take(f.noise, nullptr, &config.noise);
  take(f.log_level, "REGRASP_LOG_LEVEL", &config.log_level);
  take(f.log_format, nullptr, &config.log_format);
  take(f.stepper, nullptr, &config.stepper);
  if (f.seed && (*f.seed < 0 || static_cast<double>(*f.seed) > kMaxSafeInteger))
    throw ConfigError(fmt::format("--seed {}: expected 0 ... 2^53", *f.seed));
  if (f.seed) config.seed = static_cast<std::uint64_t>(*f.seed);
  if (f.max_clients) config.max_clients = *f.max_clients;
  if (f.paused) config.paused = true;
  CheckConfig(config, "");
  return config;
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
  const std::string_view near = NearestName(argument, names);
  return fmt::format("unknown argument {}{}", argument,
                     near.empty() ? "" : fmt::format("; did you mean {}?", near));
}

int Serve(const DaemonConfig& config) {
  StartLog(config);
  std::signal(SIGPIPE, SIG_IGN);
  Daemon daemon(config);
  spdlog::info("regraspd {} listens on {}", Version(), daemon.socket_path());
  daemon.Run(true);
  spdlog::info("stopped");
  return static_cast<int>(ExitCode::kOk);
}

int Main(int argc, char** argv) {
  CLI::App app(
      "The service of regrasp: simulates the hand, runs its controller, answers on a Unix socket.",
      "regraspd");
  Flags flags;
  AddFlags(app, flags);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    return app.exit(e);
  } catch (const CLI::ExtrasError& e) {
    return Fail(Unexpected(app), "regraspd --help", ExitCode::kUsage);
  } catch (const CLI::ParseError& e) {
    return Fail(e.what(), "regraspd --help", ExitCode::kUsage);
  }
  if (flags.version) return fmt::print("regraspd {} (protocol {})\n", Version(), kWireVersion), 0;
  if (flags.print_default) return fmt::print("{}", DefaultConfigText()), 0;
  if (flags.print_protocol) return fmt::print("{}", ProtocolPage()), 0;
  try {
    const DaemonConfig config = Resolve(flags);
    if (!flags.check) return Serve(config);
    CheckModels(config);
    fmt::print("configuration ok\n");
    return 0;
  } catch (const ConfigError& e) {
    return Fail(e.what(), "regraspd --print-default-config", ExitCode::kUsage);
  } catch (const ModelError& e) {
    return Fail(e.what(), "regraspd --check-config", ExitCode::kNotFound);
  } catch (const SocketError& e) {
    const bool busy = e.exit_code() == ExitCode::kRefused;
    return Fail(e.what(), busy ? "regrasp status" : "regraspd --socket PATH", e.exit_code());
  } catch (const std::exception& e) {
    return Fail(e.what(), "", ExitCode::kIo);
  }
}

}  // namespace
}  // namespace regrasp

int main(int argc, char** argv) { return regrasp::Main(argc, argv); }
