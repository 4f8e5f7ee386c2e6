#include "daemon/daemon.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "core/files/output_file.h"
#include "core/hand/scenario.h"
#include "core/protocol/socket_path.h"
#include "core/protocol/user_directories.h"
#include "core/sensing/noise.h"
#include "core/world/overlap_text.h"
#include "core/world/stepper_choice.h"
#include "daemon/config/reload.h"
#include "daemon/server/server.h"
#include "daemon/server/service_manager.h"

namespace regrasp {
namespace {

StepperChoice StepperFor(const std::string& word, const SessionConfig& session) {
  if (const auto stepper = StepperNamed(word)) return {*stepper, "as the configuration says"};
  StepperChoice choice = ChooseStepper(session.model, session.world);
  if (!choice.works)
    throw ModelError(
        fmt::format("{}: {}; regrasp hand check shows masses, inertias and lengths of its links",
                    session.model.hand.name, choice.reason));
  const bool fast = choice.stepper == Stepper::kFast;
  spdlog::log(fast ? spdlog::level::debug : spdlog::level::warn, "stepper {}: {}",
              Name(choice.stepper), choice.reason);
  return choice;
}

/// Names where a directory comes from that is not there.
std::vector<std::filesystem::path> SearchPath(const DaemonConfig& config) {
  try {
    return ModelSearchPath(config.models_dir);
  } catch (const ModelError& error) {
    const auto origin = config.origins.find("models_dir");
    if (origin == config.origins.end()) throw;
    ModelError named(origin->second + ": " + error.what());
    named.names_no_model = error.names_no_model;
    throw named;
  }
}

ServiceConfig MakeServiceConfig(const DaemonConfig& config) {
  CheckConfig(config, "");
  ServiceConfig service;
  service.search_path = SearchPath(config);
  service.output_dir =
      std::filesystem::absolute(config.output_dir.empty() ? DefaultOutputDir() : config.output_dir);
  service.control.speed = ParseSpeed(config.speed);
  service.control.paused = config.paused;
  service.control.clock =
      config.clock == "lockstep" ? ClockMode::kLockstep : ClockMode::kContinuous;
  service.budgets = {static_cast<std::uint64_t>(config.max_recording_mb) << 20,
                     static_cast<std::size_t>(config.max_incidents),
                     static_cast<std::size_t>(config.max_pictures),
                     static_cast<std::size_t>(config.max_checkpoints),
                     static_cast<std::size_t>(config.max_commands)};

  SessionConfig& session = service.control.session;
  service.load.inertia_from_shape = config.inertia_from_shape;
  service.load.force = config.force;
  service.load.fill_missing_meshes = config.fill_missing_meshes;
  session.model = LoadScenario(config.hand, config.object, service.search_path, service.load);
  session.seed = config.seed;
  session.noise = *NoisePreset(config.noise);
  StepperChoice choice = StepperFor(config.stepper, session);
  session.world.stepper = choice.stepper;
  service.stepper_reason = std::move(choice.reason);
  session.parameters.gravity_W = session.model.scenario.gravity_W;
  session.parameters = ParametersAfterReset(session.parameters, &session.model.object);
  auto parameters = config.parameters;
  std::ranges::stable_partition(parameters, IsPreset, [](const auto& parameter) -> decltype(auto) {
    return ParameterTable()[static_cast<std::size_t>(FindParameter(parameter.first))];
  });
  for (const auto& [name, value] : parameters) {
    Command command;
    command.parameter = FindParameter(name);
    command.value = value;
    SetParameter(&session.parameters, command);
    const auto origin = config.origins.find("parameters." + name);
    if (origin != config.origins.end()) service.parameter_origins[name] = origin->second;
  }
  return service;
}

/// Whoever names a directory wants files there: one that takes none is refused. Where nobody has,
/// the hand moves all the same, and status warns.
void TryOutput(const DaemonConfig& config, ServiceConfig* service) {
  service->output_fault = WhyNoOutput(service->output_dir.string());
  if (!service->output_fault.empty() && !config.output_dir.empty())
    throw WriteError(
        fmt::format("output_dir {}: {}", service->output_dir.string(), service->output_fault));
}

}  // namespace

Daemon::Daemon(const DaemonConfig& config, const Limits* limits) : config_(config) {
  ServiceConfig service = MakeServiceConfig(config);
  TryOutput(config, &service);
  for (const ModelWarning& warning : service.control.session.model.report.warnings)
    spdlog::warn("{}", warning.Line());
  if (const int inherited = InheritedSocket(); inherited >= 0)
    listener_ = std::make_unique<ListenSocket>(inherited);
  else
    listener_ = std::make_unique<ListenSocket>(
        ResolveSocketPath(config.socket, "", SocketUse::kListen).path);
  Limits wanted;
  if (limits) wanted = *limits;
  wanted.max_clients = static_cast<std::size_t>(config.max_clients);
  server_ = std::make_unique<Server>(std::move(service), wanted, listener_.get());
}

Daemon::~Daemon() = default;

void Daemon::Run(bool signals, const ConfigSource& source) {
  server_->Run(signals, [this, &source] { Reload(source); });
}

void Daemon::Reload(const ConfigSource& source) {
  if (!source) return;
  DaemonConfig wanted;
  try {
    wanted = source();
  } catch (const ConfigError& e) {
    spdlog::error("reload: {}; nothing has changed", e.what());
    return;
  }
  const ReloadPlan plan = PlanReload(config_, wanted);
  for (const ReloadCall& call : plan.calls) {
    const std::string refused = server_->Request(call.method, call.params);
    if (refused.empty())
      spdlog::info("reload: {}", call.what);
    else
      spdlog::warn("reload: {} refused: {}", call.what, refused);
  }
  spdlog::set_level(spdlog::level::from_str(wanted.log_level));
  server_->SetMaxClients(static_cast<std::size_t>(wanted.max_clients));
  for (const std::string& change : plan.at_once) spdlog::info("reload: {}", change);
  for (const std::string& change : plan.restart) spdlog::warn("reload: {} needs a restart", change);
  if (plan.calls.empty() && plan.at_once.empty() && plan.restart.empty())
    spdlog::info("reload: nothing has changed");
  // What needs a restart is said again at the next reload.
  config_.noise = wanted.noise;
  config_.parameters = wanted.parameters;
  config_.log_level = wanted.log_level;
  config_.max_clients = wanted.max_clients;
}

void Daemon::Stop() { server_->Stop(); }

void Daemon::StopAtEndOf(int fd) { server_->StopAtEndOf(fd); }

const std::string& Daemon::socket_path() const { return listener_->path(); }

SessionConfig MakeSessionConfig(const DaemonConfig& config) {
  return MakeServiceConfig(config).control.session;
}

std::vector<std::string> CheckModels(const DaemonConfig& config) {
  const Session session(MakeSessionConfig(config));
  std::vector<std::string> warnings;
  for (const ModelWarning& warning : session.config().model.report.warnings)
    warnings.push_back(warning.Line());
  const auto overlap = OverlapText(session.world().start_overlap(), session.config().model.hand);
  if (overlap.front() != 0)
    warnings.push_back(overlap.data() + std::string("; grasp will refuse: ") + kFitsObject);
  return warnings;
}

}  // namespace regrasp
