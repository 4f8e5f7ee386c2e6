// A drop explains itself: the record and the picture that a daemon writes.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

namespace fs = std::filesystem;

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Incidents : public SteppedDaemonTest {
 protected:
  void SetUp() override {
    SteppedDaemonTest::SetUp();
    client->Result("grasp");
    Step(6000);
    ASSERT_EQ(client->Result("status")["state"], "holding");
  }
  /// In small steps, so that no frame is lost however loaded the machine is. Friction 0.05 cannot
  /// carry the weight: friction times the force cap of every finger is less.
  void Drop() {
    client->Result("param.set", {{"name", "object.friction"}, {"value", 0.05}});
    for (int i = 0; i < 100 && client->Result("status")["state"] != "dropped"; ++i) Step(100);
    ASSERT_EQ(client->Result("status")["state"], "dropped");
  }
  Json DroppedEvent() {
    Json dropped;
    const Json answer = client->Result("events");
    for (const Json& event : answer["events"])
      if (event["kind"] == "dropped") dropped = event;
    return dropped;
  }
  std::size_t IncidentFiles() const {
    std::size_t count = 0;
    if (!fs::exists(config.output_dir)) return 0;
    for (const auto& entry : fs::directory_iterator(config.output_dir))
      count += entry.path().filename().string().starts_with("incident-");
    return count;
  }
};

TEST_F(Incidents, AreNotMadeWithoutADrop) {
  EXPECT_TRUE(client->Result("status")["incident"].is_null());
  EXPECT_EQ(client->Error("plot", {{"name", "incident"}}), -32003);
  client->Result("release");
  Step(1000);
  EXPECT_EQ(client->Result("status")["state"], "idle");  // let go on purpose
  EXPECT_EQ(IncidentFiles(), 0u);
}

TEST_F(Incidents, TellWhatLedToADrop) {
  Drop();
  const Json event = DroppedEvent(), summary = client->Result("status")["incident"];
  const std::int64_t tick = event["tick"];
  EXPECT_EQ(summary["tick"], tick);
  EXPECT_EQ(summary["record"], config.output_dir + "/" + event["incident"].get<std::string>());

  const Json record = Json::parse(Bytes(summary["record"]));
  EXPECT_EQ(record["tick"], tick);
  EXPECT_EQ(record["kind"], "dropped");
  EXPECT_EQ(record["seed"], 1);
  EXPECT_EQ(record["state_before"], "holding");
  EXPECT_TRUE(record["job"].is_null());  // the grasp had ended
  EXPECT_EQ(record["friction"], 0.05);
  const std::string cause = record["cause"];
  EXPECT_EQ(cause, summary["cause"]);
  EXPECT_NE(cause.find("object.friction = 0.05"), std::string::npos) << cause;
  ASSERT_EQ(record["findings"]["disturbances"].size(), 1u);
  EXPECT_EQ(record["findings"]["disturbances"][0]["tick"], 6000);

  // Two seconds at 100 Hz end at the drop.
  const Json& samples = record["samples"];
  const std::size_t count = samples["tick"].size();
  EXPECT_GE(count, 200u);
  EXPECT_LE(count, 201u);
  EXPECT_LE(tick - samples["tick"].back().get<std::int64_t>(), 9);
  EXPECT_EQ(samples["fingers"].size(), 5u);
  for (const auto& [name, column] : samples.items()) {
    if (name != "fingers") {
      EXPECT_EQ(column.size(), count) << name;
    }
  }
  for (const auto& [finger, columns] : samples["fingers"].items())
    for (const char* name :
         {"role", "in_contact", "force_n", "true_contact", "true_force_n", "true_force_norm_n",
          "asked_n", "load_margin_without_n", "manipulability", "joint_limit_margin_rad"})
      EXPECT_EQ(columns[name].size(), count) << finger << " " << name;

  // What it says follows from the samples.
  for (const Json& end : record["findings"]["contacts_ended"]) {
    const Json& touches = samples["fingers"][end["finger"].get<std::string>()]["true_contact"];
    EXPECT_LT(std::count(touches.end() - 3, touches.end(), true), 3) << end;  // 3: a touch
  }
  const Json& ends = record["findings"]["contacts_ended"];
  if (!ends.empty()) {
    EXPECT_NE(cause.find(ends[0]["finger"].get<std::string>()), std::string::npos);
  }
}

TEST_F(Incidents, AreDrawnAtOnceAndAgain) {
  EXPECT_EQ(client->Error("plot", {{"name", "incident"}}), -32003);
  Drop();
  const Json summary = client->Result("status")["incident"];
  // One worker draws in order: its answer means that the first picture is there as well.
  const Json again = client->Result("plot", {{"name", "incident"}});
  EXPECT_EQ(again["tick"], summary["tick"]);
  const std::string picture = Bytes(summary["picture"]);
  EXPECT_EQ(picture.substr(1, 3), "PNG");
  EXPECT_EQ(picture, Bytes(again["path"]));
  EXPECT_EQ(IncidentFiles(), 2u);
  // It outlives the run, for which it is no longer the state.
  client->Result("reset");
  EXPECT_EQ(client->Result("status")["incident"], summary);
  EXPECT_EQ(client->Error("plot", {{"name", "incident"}, {"file", "later.png"}}), 0);
}

TEST_F(Incidents, BelongToTheJobTheyEnd) {
  const Json job = client->Result("explore", {{"finger", "ring"}})["job"];
  Step(500);
  EXPECT_TRUE(client->Result("job.get", {{"id", job}})["incident"].is_null());
  Drop();
  const Json ended = client->Result("job.get", {{"id", job}});
  EXPECT_EQ(ended["error"], "the object was dropped");
  EXPECT_EQ(ended["incident"], client->Result("status")["incident"]);
  const Json record = Json::parse(Bytes(ended["incident"]["record"]));
  EXPECT_EQ(record["state_before"], "exploring");
  EXPECT_EQ(record["job"]["id"], job);
  EXPECT_EQ(record["job"]["end_tick"], record["tick"]);
  EXPECT_EQ(record["samples"]["exploring_finger"].back(), "ring");
  EXPECT_NE(record["cause"].get<std::string>().find("exploring with ring"), std::string::npos);
}

}  // namespace
}  // namespace regrasp::test
