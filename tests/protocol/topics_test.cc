// What many ask for is written once per frame: it is what would be written anew, whatever has
// happened since.

#include <gtest/gtest.h>

#include <functional>
#include <regex>

#include "core/hand/model_path.h"
#include "core/hand/scenario.h"
#include "daemon/requests/service.h"
#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

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

class Topics : public ::testing::Test {
 protected:
  Topics() : service(Config(directory / "out"), &host) { Wait(); }

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

  void DrainUntil(const std::function<bool()>& there) {
    while (!there()) {
      service.control().output().WaitUntil({});
      service.control().output().Clear();
      const std::uint64_t acknowledged = service.control().acknowledged();
      service.Drain();
      service.OnAcknowledged(acknowledged);
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
      outcome.begin([&](const Json&, const RpcError* error) {
        EXPECT_EQ(error, nullptr) << method << ": " << error->message;
      });
  }

  /// A topic without what changes by itself.
  std::string Told(const std::string& topic) {
    static const std::regex kByItself(
        R"re("(tick_p99_s|lateness_p99_s|backlog|frames_dropped|uptime_s)":[^,]*)re");
    return std::regex_replace(service.Topic(topic).fields, kByItself, "");
  }

  void ExpectFresh(const std::string& after) {
    for (const char* topic : {"status", "contacts", "joints", "quality", "truth"}) {
      const std::string told = Told(topic);
      service.Accept();
      EXPECT_EQ(told, Told(topic)) << topic << " after " << after;
    }
  }

  TemporaryDirectory directory;
  Here host;
  Service service;
  Nobody nobody;
};

TEST_F(Topics, AreWhatWouldBeWrittenAnewAfterEveryRequest) {
  const std::vector<std::pair<std::string, JsonIn>> requests = {
      {"grasp", JsonIn::object()},
      {"step", {{"ticks", 100}}},
      {"param.set", {{"name", "control.friction_estimate"}, {"value", 0.6}}},
      {"param.load", {{"parameters", {{"gait.preset", "paper"}}}}},
      {"param.reset", {{"name", "gait"}}},
      {"noise.set", {{"preset", "coarse"}}},
      {"record.start", {{"file", "run.mcap"}}},
      {"step", {{"ticks", 3000}}},
      {"resume", JsonIn::object()},
      {"pause", JsonIn::object()},
      {"record.stop", JsonIn::object()},
      {"checkpoint.save", {{"name", "held"}}},
      {"explore", {{"finger", "ring"}}},
      {"step", {{"ticks", 500}}},
      {"stop", JsonIn::object()},
      {"push", {{"force_n", {0, 0, -50}}, {"duration_s", 0.5}}},
      {"step", {{"ticks", 2000}}},
      {"checkpoint.restore", {{"name", "held"}}},
      {"reset", {{"seed", 7}}},
      {"reset", {{"object", "cube_40mm"}}},
  };
  ExpectFresh("the start");
  for (const auto& [method, params] : requests) {
    Call(method, params);
    ExpectFresh(method + ", accepted");
    Wait();
    ExpectFresh(method + ", done");
  }
}

TEST_F(Topics, AreWrittenOncePerFrame) {
  for (const char* topic : {"contacts", "joints", "quality", "truth"}) {
    const char* text = service.Topic(topic).fields.data();
    EXPECT_EQ(service.Topic(topic).fields.data(), text) << topic;
  }
}

// Its text is put together anew for each who asks, from pieces that are not.
TEST_F(Topics, StatusIsWrittenOncePerFrameButForTimesAndCounts) {
  const std::string told = Told("status");
  host.others = 6;
  auto& reason = const_cast<ServiceConfig&>(service.config()).stepper_reason;
  reason = "nobody was told";
  EXPECT_NE(Told("status"), told);  // the number of clients
  EXPECT_EQ(Told("status").find(reason), std::string::npos);
  host.others = 0;
  EXPECT_EQ(Told("status"), told);
  service.Accept();
  EXPECT_NE(Told("status").find(reason), std::string::npos);
}

TEST_F(Topics, StatusHasTheSameMembersInTheSameOrderAsEver) {
  std::vector<std::string> names;
  const Json status = Json::parse("{" + service.Topic("status").fields + "}");
  for (const auto& [name, value] : status.items()) names.push_back(name);
  const std::vector<std::string> expected = {"version",
                                             "protocol",
                                             "state",
                                             "paused",
                                             "clock",
                                             "advancing",
                                             "tick",
                                             "time_s",
                                             "dt_s",
                                             "state_hash",
                                             "real_time_factor",
                                             "tick_p99_s",
                                             "lateness_p99_s",
                                             "speed",
                                             "stepper",
                                             "stepper_reason",
                                             "seed",
                                             "hand",
                                             "object",
                                             "warnings",
                                             "stand_in",
                                             "holds_alone",
                                             "job",
                                             "incident",
                                             "gait",
                                             "noise",
                                             "changed_parameters",
                                             "recording",
                                             "clients",
                                             "backlog",
                                             "frames_dropped",
                                             "uptime_s",
                                             "output_dir"};
  EXPECT_EQ(names, expected);
}

TEST_F(Topics, QualityOfAFrameIsQualityWithoutTheRest) {
  Call("grasp", JsonIn::object());
  Call("step", {{"ticks", 3000}});
  Wait();
  Json all = Json::parse("{" + service.Topic("quality").fields + "}");
  const Json frame = Json::parse("{" + service.Topic(kFrameQuality).fields + "}");
  EXPECT_TRUE(all["volume"].is_number());
  EXPECT_FALSE(frame.contains("volume"));
  all.erase("volume");
  all["measures"] = frame["measures"];
  EXPECT_EQ(all, frame);
}

}  // namespace
}  // namespace regrasp::test
