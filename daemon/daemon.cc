#include "daemon/daemon.h"

#include <filesystem>

#include "core/hand/scenario.h"
#include "core/protocol/socket_path.h"
#include "core/sensing/noise.h"
#include "daemon/server.h"

namespace regrasp {
namespace {

ServiceConfig MakeServiceConfig(const DaemonConfig& config) {
  CheckConfig(config, "");
  ServiceConfig service;
  service.search_path = ModelSearchPath(config.models_dir);
  service.output_dir =
      std::filesystem::absolute(config.output_dir.empty() ? DefaultOutputDir() : config.output_dir);
  service.control.speed = ParseSpeed(config.speed);
  service.control.paused = config.paused;

  SessionConfig& session = service.control.session;
  session.model = LoadScenario(config.hand, config.object, service.search_path);
  session.seed = config.seed;
  session.noise = *NoisePreset(config.noise);
  session.world.stepper = config.stepper == "exact" ? Stepper::kExact : Stepper::kFast;
  session.parameters.gravity_W = session.model.scenario.gravity_W;
  session.parameters = ParametersAfterReset(session.parameters, &session.model.object);
  for (const auto& [name, value] : config.parameters) {
    Command command;
    command.parameter = FindParameter(name);
    command.value = value;
    SetParameter(&session.parameters, command);
  }
  return service;
}

}  // namespace

Daemon::Daemon(const DaemonConfig& config, const Limits* limits) {
  ServiceConfig service = MakeServiceConfig(config);
  listener_ =
      std::make_unique<ListenSocket>(ResolveSocketPath(config.socket, "", SocketUse::kListen).path);
  Limits wanted;
  if (limits) wanted = *limits;
  wanted.max_clients = static_cast<std::size_t>(config.max_clients);
  server_ = std::make_unique<Server>(std::move(service), wanted, listener_.get());
}

Daemon::~Daemon() = default;

void Daemon::Run(bool signals) { server_->Run(signals); }

void Daemon::Stop() { server_->Stop(); }

const std::string& Daemon::socket_path() const { return listener_->path(); }

void CheckModels(const DaemonConfig& config) {
  const Session session(MakeServiceConfig(config).control.session);
}

}  // namespace regrasp
