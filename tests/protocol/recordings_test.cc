// Run files over the wire: recorded by the daemon, re-executed here.

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "cli/run/replay_run.h"
#include "core/journal/journal_text.h"
#include "core/mcap/mcap_reader.h"
#include "daemon/output/recorder.h"
#include "tests/protocol/service_fixture.h"

namespace regrasp::test {
namespace {

class Recordings : public SteppedDaemonTest {
 protected:
  /// A grasp with live changes; 400 ticks.
  void GraspWithChanges() {
    client->Result("grasp");
    Step(150);
    client->Result("noise.set", {{"preset", "coarse"}});
    Step(111);
    client->Result("param.set", {{"name", "object.friction"}, {"value", 0.7}});
    client->Result("noise.set", {{"position_m", 0.0005}});
    Step(139);
  }
  static void ExpectIdentical(const run::RunFile& file) {
    const run::ReplayResult result = run::ReplayRun(file, {});
    EXPECT_FALSE(result.divergence) << run::Verdict(file, result);
    EXPECT_GT(result.compared, 10);
  }
};

TEST_F(Recordings, ReplayToTheSameStates) {
  EXPECT_EQ(client->Result("status")["recording"], Json());
  const Json started = client->Result("record.start", {{"file", "a.mcap"}});
  EXPECT_EQ(client->Result("status")["recording"], "a.mcap");
  EXPECT_EQ(client->Error("record.start"), -32002);
  GraspWithChanges();
  const Json stopped = client->Result("record.stop");
  EXPECT_EQ(stopped["dropped"], 0);
  EXPECT_EQ(client->Error("record.stop"), -32002);
  const run::RunFile file = run::ReadRunFile(started["path"]);
  EXPECT_TRUE(file.complete);
  EXPECT_EQ(file.messages, stopped["messages"]);
  ASSERT_EQ(file.segments.size(), 1u);
  EXPECT_EQ(file.segments[0].journal->entries.size(), 4u);
  EXPECT_EQ(file.segments[0].last_tick(), 400);
  EXPECT_FALSE(file.segments[0].saved.empty());
  ExpectIdentical(file);
  const Json list = client->Result("record.list")["recordings"];
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["complete"], true);
}

TEST_F(Recordings, HoldACommandBeforeAnybodyHearsWhatItDid) {
  const std::filesystem::path path = client->Result("record.start", {{"rate_hz", 100}})["path"];
  const std::filesystem::path now = path.parent_path() / "now.mcap";
  for (std::size_t commands = 1; commands <= 20; ++commands) {
    Step(100);  // samples, which are in the way
    client->Result("param.set", {{"name", "control.grip_force"}, {"value", 1 + 0.01 * commands}});
    Step(1);
    std::filesystem::copy_file(path, now, std::filesystem::copy_options::overwrite_existing);
    ASSERT_EQ(run::ReadRunFile(now).segments.at(0).journal->entries.size(), commands);
  }
}

TEST_F(Recordings, BegunInTheMiddleHoldTheRunFromItsStart) {
  GraspWithChanges();
  const Json started = client->Result("record.start");
  EXPECT_EQ(started["file"], "run-001.mcap");
  EXPECT_EQ(started["commands"], 4);
  client->Result("param.set", {{"name", "control.grip_force"}, {"value", 1.3}});
  Step(100);
  client->Result("record.stop");
  const run::RunFile file = run::ReadRunFile(started["path"]);
  EXPECT_EQ(file.segments.at(0).journal->entries.size(), 5u);
  EXPECT_GE(file.segments.at(0).states.front().tick, 400);
  ExpectIdentical(file);
}

TEST_F(Recordings, HoldResetsAndRestoredCheckpointsAsSegments) {
  const Json started = client->Result("record.start");
  GraspWithChanges();
  client->Result("checkpoint.save", {{"name", "here"}});
  client->Result("reset", {{"seed", 5}, {"object", "egg"}});
  client->Result("grasp");
  Step(120);
  Wait(client->Result("checkpoint.restore", {{"name", "here"}, {"seed", 3}})["job"]);
  Step(100);
  client->Result("record.stop");
  const run::RunFile file = run::ReadRunFile(started["path"]);
  ASSERT_EQ(file.segments.size(), 3u);
  EXPECT_EQ(file.segments[1].journal->config.model.object.name, "egg");
  EXPECT_EQ(file.segments[2].last_tick(), 500);
  ExpectIdentical(file);
}

TEST_F(Recordings, ShowATamperedCommandAtItsTick) {
  const Json started = client->Result("record.start");
  GraspWithChanges();
  client->Result("record.stop");
  run::RunFile file = run::ReadRunFile(started["path"]);
  Journal& journal = *file.segments[0].journal;
  const auto difference = [&] { return run::ReplayRun(file, {}).divergence; };

  const Journal original = journal;
  journal.entries[2].command.value[0] = 0.7000001;  // friction, tick 261
  ASSERT_TRUE(difference());
  EXPECT_EQ(difference()->tick, 261);
  EXPECT_EQ(difference()->command, 2);
  EXPECT_EQ(difference()->last_equal, 261);  // the state before the command

  journal = original;
  journal.entries[1].tick += 1;  // noise, one tick late
  ASSERT_TRUE(difference());
  EXPECT_GE(difference()->tick, 150);
  EXPECT_LE(difference()->tick, 151);

  journal = original;
  journal.entries.erase(journal.entries.begin() + 1);  // states stand every 10 ticks
  ASSERT_TRUE(difference());
  EXPECT_GT(difference()->tick, 150);
  EXPECT_LE(difference()->tick, 160);

  journal = original;
  journal.config.seed += 1;
  ASSERT_TRUE(difference());
  EXPECT_EQ(difference()->tick, 0);
}

TEST_F(Recordings, RefuseNamesAndFilesThatExist) {
  EXPECT_EQ(client->Error("record.start", {{"file", "../a.mcap"}}), -32602);
  EXPECT_EQ(client->Error("record.start", {{"file", "a.png"}}), -32602);
  client->Result("record.start", {{"file", "a.mcap"}});
  client->Result("record.stop");
  EXPECT_EQ(client->Error("record.start", {{"file", "a.mcap"}}), -32007);
  EXPECT_EQ(client->Result("status")["recording"], Json());
}

TEST_F(Recordings, SampleAtTheRateThatWasAskedFor) {
  const Json started = client->Result("record.start", {{"rate_hz", 10}});
  Step(1000);
  client->Result("record.stop");
  std::map<std::string, int> counts;
  ReadMcap(started["path"],
           [&](const McapMessage& message) { ++counts[std::string(message.topic)]; });
  EXPECT_EQ(counts["joints"], 11);  // tick 0, 100, ... 1000
  EXPECT_EQ(counts["object"], 11);
  EXPECT_GE(counts["state"], 100);
  EXPECT_EQ(counts["gait"], 0);  // nothing rotates
}

/// Without a look at what the control thread has told.
void WaitFor(const std::function<bool()>& there) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!there() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
  ASSERT_TRUE(there());
}

// The frames come with the mark of the stop, and are shown after it.
TEST_F(ServiceTest, ARecordingHoldsWhatNobodyHasBeenShownYet) {
  Call("record.start", {{"file", "a.mcap"}});
  const std::uint64_t pulse = service.control().pulse();
  Call("step", {{"ticks", 500}});
  WaitFor([&] { return service.control().pulse() >= pulse + 500; });
  const std::uint64_t acknowledged = service.control().acknowledged();
  Call("record.stop", JsonIn::object());
  WaitFor([&] { return service.control().acknowledged() > acknowledged; });
  DrainUntil([&] { return !service.recorder(); });
  const run::RunFile file = run::ReadRunFile(directory / "out/a.mcap");
  EXPECT_GE(file.segments.at(0).last_tick(), 400);  // the thread also counts a few times it woke
}

// It is full in the very Drain() that brings the mark.
TEST_F(ServiceTest, AStopTellsWhyTheRecordingHasEndedMeanwhile) {
  const_cast<ServiceConfig&>(service.config()).budgets.recording_bytes = 1;
  Call("record.start", {{"file", "a.mcap"}});
  WaitFor([&] { return service.recorder()->numbers().full; });
  Outcome outcome = service.Call("record.stop", JsonIn::object(), &nobody);
  std::string told;
  outcome.begin(
      [&](const Json&, const RpcError* error) { told = error ? error->message : "done"; });
  DrainUntil([&] { return !told.empty(); });
  EXPECT_NE(told.find("as much as one run file may have"), std::string::npos) << told;
  EXPECT_TRUE(service.recording_end.empty());
}

}  // namespace
}  // namespace regrasp::test
