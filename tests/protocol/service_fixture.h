#pragma once

/// A service without a server or a socket: what its handlers do, and what comes of it when the test
/// lets it look at what the control thread has told.

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/hand/model_path.h"
#include "core/hand/scenario.h"
#include "daemon/requests/service.h"
#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {

/// Runs what is given to it at once.
class Here final : public Host {
 public:
  std::uint64_t After(double, std::function<void()>) override { return 1; }
  void Cancel(std::uint64_t) override {}
  bool Background(std::function<void()> work, std::function<void()> finish) override {
    work();
    finish();
    return true;
  }
  std::size_t clients() const override { return 1 + others; }
  void Shutdown() override {}
  bool activated() const override { return false; }

  std::size_t others = 0;
};

class Nobody final : public Client {
 public:
  std::int64_t Subscribe(const std::string&, double) override { return 0; }
  Json Unsubscribe(std::int64_t) override { return {}; }
};

/// Paused, at --speed max.
class ServiceTest : public ::testing::Test {
 protected:
  ServiceTest() : service(Config(directory / "out"), &host) { Wait(); }

  static ServiceConfig Config(const std::string& output_dir) {
    ServiceConfig config;
    config.search_path = ModelSearchPath();
    config.output_dir = output_dir;
    config.control.paused = true;
    config.control.speed = kMaxSpeed;
    SessionConfig& session = config.control.session;
    session.model = LoadScenario("shadow", "sphere", config.search_path, config.load);
    session.parameters.gravity_W = session.model.scenario.gravity_W;
    session.parameters = ParametersAfterReset(session.parameters, &session.model.object);
    std::filesystem::create_directories(output_dir);
    return config;
  }

  /// As the server does when the control thread has told something.
  void Drain() {
    service.control().output().Clear();
    const std::uint64_t acknowledged = service.control().acknowledged();
    service.Drain();
    service.OnAcknowledged(acknowledged);
  }
  void DrainUntil(const std::function<bool()>& there) {
    while (!there()) {
      service.control().output().WaitUntil({});
      Drain();
    }
  }
  /// Until the control thread has done what was asked for, and a frame shows it.
  void Wait() {
    DrainUntil([this] { return !service.jobs().Restoring(); });
    bool taken = false;
    service.Mark(ControlRequest::Part::kNothing, [&](const JournalNews&) { taken = true; });
    DrainUntil([&] { return taken && !service.jobs().UnfinishedStep(); });
  }

  void Call(const std::string& method, const JsonIn& params) {
    Outcome outcome = service.Call(method, params, &nobody);
    if (outcome.begin)
      outcome.begin([method](const Json&, const RpcError* error) {
        EXPECT_EQ(error, nullptr) << method << ": " << error->message;
      });
  }

  TemporaryDirectory directory;
  Here host;
  Service service;
  Nobody nobody;
};

}  // namespace regrasp::test
