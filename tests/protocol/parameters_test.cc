// Parameters over the wire: types, defaults, sources, many at once.

#include <gtest/gtest.h>

#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

class ParameterRequests : public SteppedDaemonTest {
 protected:
  Json Get(const char* name) { return client->Result("param.get", {{"name", name}}); }
  /// Names of the parameters that differ from their defaults.
  std::vector<std::string> Changed() {
    std::vector<std::string> names;
    const Json list = client->Result("param.list", {{"changed", true}})["parameters"];
    for (const Json& p : list) names.push_back(p["name"]);
    return names;
  }
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
  EXPECT_EQ(error["data"]["allowed"], Json({"exploring", "returning"}));
  const Json data = client->Ask("param.set", {{"name", "gait.hop"}, {"value", 2}})["error"]["data"];
  EXPECT_EQ(data["hint"], "allowed: true or false");
  EXPECT_EQ(data["allowed"], Json({"true", "false"}));
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
  // All that is wrong is told at once.
  const Json many = load(
      {{"gait.hop", false}, {"gait.lead", 7}, {"gait.mode", "walk"}, {"gait.mood", 1}})["error"];
  EXPECT_EQ(many["code"], -32602);
  EXPECT_TRUE(
      many["message"].get<std::string>().starts_with("3 errors:\n  gait.lead = 7 is out of"))
      << many.dump();
  ASSERT_EQ(many["data"]["errors"].size(), 3u) << many.dump();
  EXPECT_EQ(many["data"]["param"], "gait.lead");
  EXPECT_FALSE(many["data"].contains("more"));
  const char* const blamed[] = {"gait.lead", "gait.mode", "gait.mood"};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(many["data"]["errors"][i]["data"]["param"], blamed[i]);
  EXPECT_EQ(many["data"]["errors"][1]["code"], -32602);
  EXPECT_EQ(many["data"]["errors"][2]["code"], -32003);
  Json thousand = Json::object();
  for (int i = 0; i < 1000; ++i) thousand["x" + std::to_string(i)] = 1;
  const Json unknown = load(thousand)["error"];
  EXPECT_EQ(unknown["data"]["errors"].size(), 50u);
  EXPECT_EQ(unknown["data"]["more"], 950);
  EXPECT_TRUE(unknown["message"].get<std::string>().ends_with("\n  and 950 more"));
  // One code is that of all, and the first is blamed.
  EXPECT_EQ(unknown["code"], -32003);
  EXPECT_EQ(unknown["data"]["param"], "x0");
  EXPECT_GT(unknown["data"]["allowed"].size(), 100u);
  thousand["x999"] = 1, thousand["zoom"] = 1, thousand["gait.lead"] = 7;
  EXPECT_EQ(load(thousand)["error"]["code"], -32602);
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

TEST_F(ParameterRequests, APresetDoesNotUndoWhatIsSetWithIt) {
  const auto load = [&](const Json& values) {
    return client->Result("param.load", {{"parameters", values}});
  };
  client->Result("param.set", {{"name", "gait.preset"}, {"value", "paper"}});
  client->Result("param.set", {{"name", "gait.margin_min"}, {"value", 0.05}});
  const Json saved = client->Result("status")["changed_parameters"];
  EXPECT_EQ(saved["gait.margin_min"], 0.05);
  EXPECT_EQ(saved["gait.mode"], "exploring");
  client->Result("param.reset");
  EXPECT_EQ(Changed(), Names{});
  load(saved);
  EXPECT_EQ(client->Result("status")["changed_parameters"], saved);
  // Also where only the preset changes what already has the value.
  client->Result("param.reset", {{"name", "gait.preset"}});
  client->Result("param.set", {{"name", "gait.margin_min"}, {"value", 0.05}});
  const Json kept = load({{"gait.margin_min", 0.05}, {"gait.preset", "paper"}})["kept"];
  EXPECT_EQ(client->Result("status")["changed_parameters"], saved);
  EXPECT_EQ(kept, Json::object());
}

TEST_F(ParameterRequests, WhatAPresetChangesIsListedAndNamesIt) {
  client->Result("param.set", {{"name", "gait.preset"}, {"value", "paper"}});
  EXPECT_EQ(Get("gait.preset")["source"], "set while running");
  EXPECT_EQ(Get("gait.mode")["source"], "gait.preset");
  client->Result("param.set", {{"name", "gait.max_excursion"}, {"value", 0.02}});
  EXPECT_EQ(Get("gait.max_excursion")["source"], "set while running");
  const Names changed = Changed();
  EXPECT_EQ(changed, (Names{"gait.along_speed", "gait.explore_s", "gait.forgive", "gait.margin_min",
                            "gait.max_excursion", "gait.mode", "gait.plan", "gait.preset"}));
  Names listed;
  const Json reset = client->Result("param.reset", {{"name", "gait.preset"}});
  for (const Json& p : reset["parameters"]) {
    listed.push_back(p["name"]);
    EXPECT_NE(p["before"], p["value"]) << p.dump();
    EXPECT_EQ(p["changed"], false);
  }
  EXPECT_EQ(listed, changed);
  EXPECT_EQ(Changed(), Names{});
}

TEST_F(ParameterRequests, ABatchThatARunningJobCanDoWithIsTakenWhole) {
  const auto finish = [&](const char* job, const Json& params) {
    const Json id = client->Result(job, params)["job"];
    client->Result(
        "job.wait",
        {{"id", client->Result("step", {{"ticks", 200'000}, {"until_job_ends", true}})["job"]}});
    return client->Result("job.get", {{"id", id}});
  };
  const auto step = [&](int ticks) {
    client->Result("job.wait", {{"id", client->Result("step", {{"ticks", ticks}})["job"]}});
  };
  ASSERT_EQ(finish("grasp", Json::object())["state"], "done");
  client->Result("param.set", {{"name", "gait.mode"}, {"value", "exploring"}});
  client->Result("rotate", {{"turns", 1}});
  step(100);
  ASSERT_EQ(client->Result("status")["state"], "rotating");
  // In the order of names the first would be too slow for the mode that still is.
  client->Result(
      "param.load",
      {{"parameters", {{"control.stability_measure", "epsilon"}, {"gait.mode", "returning"}}}});
  step(10);
  EXPECT_EQ(client->Result("quality")["stability_measure"], "epsilon");
  // The way back, and what has no way.
  EXPECT_EQ(client->Error("param.load", {{"parameters", {{"gait.mode", "exploring"}}}}), -32002);
  client->Result(
      "param.load",
      {{"parameters",
        {{"control.stability_measure", "min_singular_value"}, {"gait.mode", "exploring"}}}});
  EXPECT_EQ(client->Error(
                "param.load",
                {{"parameters", {{"control.stability_measure", "epsilon"}, {"gait.lead", 0.25}}}}),
            -32002);
  step(10);
  EXPECT_EQ(client->Result("quality")["stability_measure"], "min_singular_value");
  const Json events = client->Result("events")["events"];
  for (const Json& event : events)
    EXPECT_FALSE(event["text"].get<std::string>().starts_with("refused:")) << event.dump();
}

TEST_F(ParameterRequests, ABatchThatNoLongerFitsIntoTheRunIsLeftOutWhole) {
  Finish();
  config.max_commands = 1;
  Start();
  client = Connect();
  EXPECT_EQ(
      client->Error("param.load", {{"parameters", {{"gait.hop", false}, {"gait.lead", 0.25}}}}),
      -32001);
  EXPECT_EQ(Changed(), Names{});
  EXPECT_EQ(client->Error("param.load", {{"parameters", {{"gait.hop", false}}}}), 0);
}

TEST_F(DaemonTest, AConfiguredPresetDoesNotUndoWhatIsConfiguredWithIt) {
  config.parameters.emplace_back("gait.margin_min", Vector3d(0.05, 0, 0));
  config.parameters.emplace_back("gait.preset", Vector3d(1, 0, 0));
  config.origins["parameters.gait.margin_min"] = "regraspd.toml:2";
  config.origins["parameters.gait.preset"] = "regraspd.toml:3";
  Start();
  const auto client = Connect();
  const auto get = [&](const char* name) { return client->Result("param.get", {{"name", name}}); };
  ASSERT_EQ(get("gait.preset")["value"], "paper");
  EXPECT_EQ(get("gait.margin_min")["value"], 0.05);
  EXPECT_EQ(get("gait.margin_min")["source"], "configuration, regraspd.toml:2");
  EXPECT_EQ(get("gait.mode")["value"], "exploring");
  EXPECT_EQ(get("gait.mode")["source"], "gait.preset");
  // Overwritten by a preset it is the configuration's no longer.
  client->Result("param.set", {{"name", "gait.preset"}, {"value", "paper"}});
  EXPECT_EQ(get("gait.margin_min")["source"], "gait.preset");
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
