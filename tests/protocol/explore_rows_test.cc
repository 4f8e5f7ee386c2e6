// Every criterion and every estimator of the gradient is taken wherever its name or number comes
// by: over the wire, as a parameter, in the commands of a run file and in a saved state.

#include <gtest/gtest.h>

#include "core/exploration/criterion.h"
#include "core/exploration/estimator.h"
#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

class ExploreRows : public SteppedDaemonTest {
 protected:
  void SetUp() override {
    SteppedDaemonTest::SetUp();
    client->Result("param.set", {{"name", "exploration.turn_axis"}, {"value", {0, 0, -1}}});
    const Json grasp = client->Result("grasp")["job"];
    for (int k = 0; k < 50 && Record(grasp)["state"] != "done"; ++k) Step(100);
    ASSERT_EQ(client->Result("status")["state"], "holding");
    client->Result("checkpoint.save", {{"name", "holding"}});
  }
  Json Record(const Json& job) { return client->Result("job.get", {{"id", job}}); }
  std::string Hash() { return client->Result("status")["state_hash"]; }
  Json Restore(const std::string& name, bool reexecute) {
    const Json answer =
        client->Result("checkpoint.restore", {{"name", name}, {"reexecute", reexecute}});
    EXPECT_EQ(Wait(answer["job"])["state"], "done") << name;
    return answer;
  }
  /// `name` as the value of the parameter gait.KEY and of KEY of an exploration, which is under way
  /// when its state is saved and its commands are executed again.
  void Walk(const std::string& key, const std::string& name) {
    SCOPED_TRACE(key + " " + name);
    Restore("holding", false);
    const Json parameter = {{"name", "gait." + key}};
    client->Result("param.set", {{"name", "gait." + key}, {"value", name}});
    Json params = {{"finger", "ring"}};
    params[key] = name;
    const Json job = client->Result("explore", params)["job"];
    Step(700);
    EXPECT_EQ(client->Result("param.get", parameter)["value"], name);
    const Json record = Record(job);
    EXPECT_EQ(record["state"], "running") << record;
    EXPECT_EQ(record[key], name);
    EXPECT_GT(client->Result("quality")["exploration"]["cycle"], 100);  // Algorithm 1 is at work
    client->Result("checkpoint.save", {{"name", key + "-" + name}});
    const std::string saved = Hash();
    Step(50);
    const std::string later = Hash();
    for (const bool reexecute : {false, true}) {
      const Json answer = Restore(key + "-" + name, reexecute);
      EXPECT_EQ(answer["from"], reexecute ? "commands" : "state");
      EXPECT_EQ(Hash(), saved);
      EXPECT_EQ(client->Result("param.get", parameter)["value"], name);
      EXPECT_EQ(Record(answer["continues"])[key], name);
      Step(50);
      EXPECT_EQ(Hash(), later);
    }
  }
};

TEST_F(ExploreRows, EveryEstimatorIsTakenEverywhere) {
  for (const EstimatorInfo& row : kEstimatorTable) Walk("estimator", std::string(row.name));
}

TEST_F(ExploreRows, EveryCriterionIsTakenEverywhere) {
  for (const CriterionInfo& row : kCriterionTable) Walk("criterion", std::string(row.name));
}

}  // namespace
}  // namespace regrasp::test
