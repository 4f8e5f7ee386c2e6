// Parameters over the wire: types, defaults, sources, many at once.

#include <gtest/gtest.h>

#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

class ParameterRequests : public DaemonTest {
 protected:
  void SetUp() override {
    config.paused = true;
    Start();
    client = Connect();
  }
  Json Get(const char* name) { return client->Result("param.get", {{"name", name}}); }
  /// Names of the parameters that differ from their defaults.
  std::vector<std::string> Changed() {
    std::vector<std::string> names;
    const Json list = client->Result("param.list", {{"changed", true}})["parameters"];
    for (const Json& p : list) names.push_back(p["name"]);
    return names;
  }
  std::unique_ptr<TestClient> client;
};

using Names = std::vector<std::string>;

TEST_F(ParameterRequests, WordsAndBooleansAreSpokenAndTheirNumbersUnderstood) {
  EXPECT_EQ(Get("gait.mode")["value"], "returning");
  EXPECT_EQ(Get("gait.mode")["words"], Json({"exploring", "returning"}));
  client->Result("param.set", {{"name", "gait.mode"}, {"value", "exploring"}});
  EXPECT_EQ(Get("gait.mode")["value"], "exploring");
  client->Result("param.set", {{"name", "gait.mode"}, {"value", 1}});
  EXPECT_EQ(Get("gait.mode")["value"], "returning");
  EXPECT_EQ(Get("gait.hop")["value"], true);
  client->Result("param.set", {{"name", "gait.hop"}, {"value", 0}});
  EXPECT_EQ(Get("gait.hop")["value"], false);
  EXPECT_EQ(Get("exploration.max_cycles")["type"], "integer");
  EXPECT_EQ(client->Error("param.set", {{"name", "gait.mode"}, {"value", 2}}), -32602);
  EXPECT_EQ(client->Error("param.set", {{"name", "gait.hop"}, {"value", "yes"}}), -32602);
  const Json error =
      client->Ask("param.set", {{"name", "gait.mode"}, {"value", "explorin"}})["error"];
  EXPECT_EQ(error["data"]["hint"], "did you mean 'exploring'?");
  EXPECT_EQ(
      client->Ask("param.set", {{"name", "object.friction"}, {"value", "0,5"}})["error"]["message"],
      "object.friction is one number, with a point, not '0,5'");
}

TEST_F(ParameterRequests, AChangedValueDoesNotClaimTheSourceOfTheDefault) {
  EXPECT_EQ(Get("exploration.lambda")["source"], "paper");
  client->Result("param.set", {{"name", "exploration.lambda"}, {"value", 0.8}});
  Json lambda = Get("exploration.lambda");
  EXPECT_EQ(lambda["source"], "set while running");
  EXPECT_EQ(lambda["default_source"], "paper");
  EXPECT_EQ(lambda["default"], 0.9);
  EXPECT_EQ(lambda["changed"], true);
  EXPECT_EQ(Changed(), Names{"exploration.lambda"});
  EXPECT_EQ(client->Result("status")["changed_parameters"], Json({{"exploration.lambda", 0.8}}));
  EXPECT_EQ(client->Result("reset")["changed_parameters"], Json({{"exploration.lambda", 0.8}}));
  client->Result("param.set", {{"name", "exploration.lambda"}, {"value", 0.9}});
  lambda = Get("exploration.lambda");
  EXPECT_EQ(lambda["source"], "paper");
  EXPECT_EQ(Changed(), Names{});
}

TEST_F(ParameterRequests, ResetTakesAParameterAGroupOrAll) {
  const auto change = [&] {
    client->Result("param.load", {{"parameters",
                                   {{"gait.mode", "exploring"},
                                    {"gait.lead", 0.25},
                                    {"gravity", {0, 0, -1.62}},
                                    {"object.friction", 0.6}}}});
  };
  change();
  EXPECT_EQ(client->Result("param.reset", {{"name", "gait.lead"}})["parameters"][0]["before"],
            0.25);
  EXPECT_EQ(Changed(), (Names{"gait.mode", "gravity", "object.friction"}));
  client->Result("param.reset", {{"name", "gait"}});
  EXPECT_EQ(Changed(), (Names{"gravity", "object.friction"}));
  change();
  client->Result("param.reset");
  EXPECT_EQ(Changed(), Names{});
  EXPECT_EQ(client->Error("param.reset", {{"name", "gate"}}), -32003);
  EXPECT_EQ(client->Error("param.list", {{"group", "gate"}}), -32003);
  const Json gait = client->Result("param.list", {{"group", "gait"}})["parameters"];
  EXPECT_GT(gait.size(), 10u);
  for (const Json& p : gait)
    EXPECT_TRUE(p["name"].get<std::string>().starts_with("gait.")) << p.dump();
}

TEST_F(ParameterRequests, ManyAreSetOrNone) {
  client->Result("param.set", {{"name", "gait.lead"}, {"value", 0.25}});
  const auto load = [&](const Json& values) {
    return client->Ask("param.load", {{"parameters", values}});
  };
  EXPECT_EQ(load({{"gait.hop", false}, {"gait.mode", "walk"}})["error"]["data"]["param"],
            "gait.mode");
  EXPECT_EQ(load({{"gait.hop", false}, {"gait.mood", 1}})["error"]["code"], -32003);
  EXPECT_EQ(load({{"gait.hop", false}, {"gravity", {{"x", 1}}}})["error"]["code"], -32602);
  EXPECT_EQ(client->Error("param.load", {{"parameters", 3}}), -32602);
  EXPECT_EQ(Changed(), Names{"gait.lead"});
  EXPECT_EQ(load({{"gait.hop", false}})["result"]["kept"], Json({{"gait.lead", 0.25}}));
  EXPECT_EQ(Changed(), (Names{"gait.hop", "gait.lead"}));

  // The whole table at once, while nothing is stepped.
  Json all = Json::object();
  const Json list = client->Result("param.list")["parameters"];
  for (const Json& p : list) all[p["name"].get<std::string>()] = p["default"];
  EXPECT_EQ(load(all)["result"]["parameters"].size(), list.size());
  EXPECT_EQ(Changed(), Names{});
}

TEST_F(DaemonTest, AConfiguredValueTellsItsPlace) {
  config.parameters.emplace_back("gait.lead", Vector3d(0.25, 0, 0));
  config.origins["parameters.gait.lead"] = "/etc/regrasp/regraspd.toml:7";
  Start();
  const auto client = Connect();
  EXPECT_EQ(client->Result("param.get", {{"name", "gait.lead"}})["source"],
            "configuration, /etc/regrasp/regraspd.toml:7");
  client->Result("param.set", {{"name", "gait.lead"}, {"value", 0.3}});
  EXPECT_EQ(client->Result("param.get", {{"name", "gait.lead"}})["source"], "set while running");
}

}  // namespace
}  // namespace regrasp::test
