// What many ask for is written once per frame: it is what would be written anew, whatever has
// happened since.

#include <gtest/gtest.h>

#include <regex>

#include "tests/protocol/service_fixture.h"

namespace regrasp::test {
namespace {

class Topics : public ServiceTest {
 protected:
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
