// Checkpoints over the wire: to go on identically, to branch, and what is refused.

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

class Checkpoints : public SteppedDaemonTest {
 protected:
  std::string Hash() { return client->Result("status")["state_hash"]; }
  /// Restores and returns the record of the restore.
  Json Restore(const Json& params) {
    return Wait(client->Result("checkpoint.restore", params)["job"]);
  }
  /// 200 ticks into a grasp: a job is running, fingers move.
  void SaveInTheGrasp() {
    client->Result("grasp");
    Step(200);
    client->Result("param.set", {{"name", "object.friction"}, {"value", 0.7}});
    saved = client->Result("checkpoint.save", {{"name", "start"}});
  }
  Json saved;
};

TEST_F(Checkpoints, GoOnToTheSameBits) {
  SaveInTheGrasp();
  EXPECT_EQ(saved["tick"], 200);
  EXPECT_EQ(saved["commands"], 2);  // the parameter, though it still waited for its tick
  EXPECT_EQ(saved["state_hash"], Hash());
  client->Result("noise.set", {{"preset", "coarse"}});
  Step(300);
  const std::string unbranched = Hash();
  client->Result("noise.set", {{"preset", "off"}});
  Step(10);

  const Json answer = client->Result("checkpoint.restore", {{"name", "start"}});
  EXPECT_EQ(Wait(answer["job"])["state"], "done");
  EXPECT_EQ(client->Result("status")["tick"], 200);
  EXPECT_EQ(Hash(), saved["state_hash"]);
  // What is in force is what was in force then.
  EXPECT_EQ(client->Result("noise.get")["preset"], "paper");
  EXPECT_EQ(client->Result("param.get", {{"name", "object.friction"}})["value"], 0.7);
  // The grasp goes on, as a job of this daemon.
  EXPECT_EQ(client->Result("job.get", {{"id", answer["continues"]}})["state"], "running");
  client->Result("noise.set", {{"preset", "coarse"}});
  Step(300);
  EXPECT_EQ(Hash(), unbranched);
}

TEST_F(Checkpoints, BranchBySeed) {
  SaveInTheGrasp();
  const auto branch = [&](const Json& params) {
    EXPECT_EQ(Restore(params)["state"], "done");
    Step(50);
    return Hash();
  };
  const Json same = {{"name", "start"}, {"seed", 7}};
  const std::string first = branch(same);
  EXPECT_EQ(client->Result("status")["seed"], 7);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(branch(same), first);
  std::set<std::string> hashes = {first, branch({{"name", "start"}})};
  for (int seed = 8; seed < 12; ++seed) hashes.insert(branch({{"name", "start"}, {"seed", seed}}));
  EXPECT_EQ(hashes.size(), 6u);
}

TEST_F(Checkpoints, OfABranchGoOnToo) {
  SaveInTheGrasp();
  Restore({{"name", "start"}, {"seed", 7}});
  Step(20);
  client->Result("checkpoint.save", {{"name", "branch"}});
  Step(30);
  const std::string hash = Hash();
  EXPECT_EQ(Restore({{"name", "branch"}})["state"], "done");
  Step(30);
  EXPECT_EQ(Hash(), hash);
}

TEST_F(Checkpoints, OutliveTheDaemonAndAReset) {
  SaveInTheGrasp();
  Step(100);
  const std::string unbranched = Hash();
  client.reset();
  Finish();
  config.seed = 99;
  Start();
  client = Connect();
  client->Result("reset", {{"object", "egg"}});
  EXPECT_EQ(Restore({{"name", "start"}})["state"], "done");
  EXPECT_EQ(client->Result("status")["object"], saved["object"]);
  Step(100);
  EXPECT_EQ(Hash(), unbranched);
  const Json list = client->Result("checkpoint.list")["checkpoints"];
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["name"], "start");
  EXPECT_EQ(list[0]["same_build"], true);
}

TEST_F(Checkpoints, BringTheirStepperWithThemAndStatusTellsIt) {
  SaveInTheGrasp();
  ASSERT_EQ(client->Result("status")["stepper"], "fast");
  client.reset();
  Finish();
  config.stepper = "exact";
  Start();
  client = Connect();
  EXPECT_EQ(client->Result("status")["stepper"], "exact");
  EXPECT_EQ(client->Result("status")["stepper_reason"], "as the configuration says");
  EXPECT_EQ(Restore({{"name", "start"}})["state"], "done");
  for (const char* reset : {"", "reset"}) {  // later runs keep it
    if (*reset) client->Result(reset);
    EXPECT_EQ(client->Result("status")["stepper"], "fast") << reset;
    EXPECT_EQ(client->Result("status")["stepper_reason"], "that of the checkpoint's run") << reset;
    EXPECT_EQ(client->Result("identity")["stepper"], "fast") << reset;
  }
}

TEST_F(Checkpoints, AreReadBackWhateverTheStepper) {
  for (const char* stepper : {"exact", "round"}) {
    client.reset();
    Finish();
    config.stepper = stepper;
    Start();
    client = Connect();
    client->Result("checkpoint.save", {{"name", stepper}});
    EXPECT_EQ(Restore({{"name", stepper}})["state"], "done") << stepper;
    EXPECT_EQ(client->Result("status")["stepper"], stepper);
  }
}

TEST_F(Checkpoints, ThatWereChangedAreRefusedAtTheTickAndThePresentRunGoesOn) {
  SaveInTheGrasp();
  const std::string path = saved["path"];
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string changed = text.str();
  const auto at = changed.find("[0.7,0.0,0.0]");  // the parameter command of tick 200
  ASSERT_NE(at, std::string::npos);
  changed.replace(at, 13, "[0.8,0.0,0.0]");
  std::ofstream(path) << changed;
  Step(5);
  const std::string before = Hash();
  const Json record = Restore({{"name", "start"}});
  EXPECT_EQ(record["state"], "failed");
  EXPECT_NE(record["error"].get<std::string>().find("tick 200"), std::string::npos) << record;
  EXPECT_EQ(Hash(), before);
  std::ofstream(path) << changed.substr(0, changed.size() / 2);
  EXPECT_EQ(client->Error("checkpoint.restore", {{"name", "start"}}), -32007);
}

TEST_F(Checkpoints, LoadTheStateOrExecuteTheCommandsAgainToTheSameBits) {
  SaveInTheGrasp();
  Step(100);
  const std::string later = Hash();
  for (const bool again : {false, true}) {
    const Json answer =
        client->Result("checkpoint.restore", {{"name", "start"}, {"reexecute", again}});
    EXPECT_EQ(answer["from"], again ? "commands" : "state");
    EXPECT_EQ(Wait(answer["job"])["state"], "done");
    EXPECT_EQ(Hash(), saved["state_hash"]);
    Step(100);
    EXPECT_EQ(Hash(), later);
  }
}

/// Changes `from` to `to` in a file.
void Replace(const std::string& path, const std::string& from, const std::string& to) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string changed = text.str();
  const auto at = changed.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  changed.replace(at, from.size(), to);
  std::ofstream(path) << changed;
}

TEST_F(Checkpoints, OfAnotherBuildAreExecutedAgain) {
  SaveInTheGrasp();
  Step(5);
  Replace(saved["path"], "\"build\":\"", "\"build\":\"x");
  EXPECT_EQ(client->Result("checkpoint.list")["checkpoints"][0]["same_build"], false);
  const Json answer = client->Result("checkpoint.restore", {{"name", "start"}});
  EXPECT_EQ(answer["from"], "commands");
  EXPECT_EQ(Wait(answer["job"])["state"], "done");
  EXPECT_EQ(Hash(), saved["state_hash"]);
}

TEST_F(Checkpoints, WithADamagedStateAreRefusedByNameButTheCommandsStillLeadThere) {
  SaveInTheGrasp();
  Step(5);
  const std::string before = Hash();
  Replace(saved["path"], "\"saved_state\":\"", "\"saved_state\":\"AAAA");
  EXPECT_EQ(client->Error("checkpoint.restore", {{"name", "start"}}), -32007);
  EXPECT_EQ(Hash(), before);
  EXPECT_EQ(Restore({{"name", "start"}, {"reexecute", true}})["state"], "done");
  EXPECT_EQ(Hash(), saved["state_hash"]);
}

TEST_F(Checkpoints, TellThatTheyReplaceOneOfTheirName) {
  EXPECT_EQ(client->Result("checkpoint.save", {{"name", "here"}})["replaced"], false);
  Step(5);
  EXPECT_EQ(client->Result("checkpoint.save", {{"name", "here"}})["replaced"], true);
  EXPECT_EQ(client->Result("checkpoint.list")["checkpoints"].size(), 1u);
}

TEST_F(Checkpoints, AreRefusedByName) {
  EXPECT_EQ(client->Error("checkpoint.save", {{"name", "../x"}}), -32602);
  EXPECT_EQ(client->Error("checkpoint.save", {{"name", ""}}), -32602);
  EXPECT_EQ(client->Error("checkpoint.restore", {{"name", "nothing"}}), -32003);
  EXPECT_EQ(client->Result("checkpoint.list")["checkpoints"].size(), 0u);
}

}  // namespace
}  // namespace regrasp::test
