// Jobs, the clock, and repeatability, over the wire.

#include <gtest/gtest.h>

#include "daemon/wire/frame_json.h"
#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

class Jobs : public SteppedDaemonTest {};

TEST_F(Jobs, AreQueuedWhilePausedAndStartAtTheNextTick) {
  const Json job = client->Result("grasp")["job"];
  EXPECT_EQ(client->Result("job.get", {{"id", job}})["state"], "queued");
  EXPECT_EQ(client->Result("status")["state"], "idle");
  Step(1);
  const Json record = client->Result("job.get", {{"id", job}});
  EXPECT_EQ(record["state"], "running");
  EXPECT_EQ(record["start_tick"], 0);
  EXPECT_EQ(record["end_tick"], Json());
  EXPECT_EQ(record["ended_s"], Json());
  EXPECT_EQ(client->Result("status")["state"], "grasping");
}

TEST_F(Jobs, ASecondOneIsBusyEvenBeforeTheFirstHasBegun) {
  client->Result("grasp");
  EXPECT_EQ(client->Error("grasp"), -32001);
  EXPECT_EQ(client->Error("explore", {{"finger", "ring"}}), -32001);
  EXPECT_EQ(client->Result("job.list")["jobs"].size(), 1u);  // refused ones leave no record
}

// Paused, a command waits for the next tick: what ends a job before that keeps it from beginning.
TEST_F(Jobs, OneThatHasNotBegunEndsWithoutBeginning) {
  for (const char* method : {"stop", "job.cancel"}) {
    SCOPED_TRACE(method);
    const Json id = client->Result("grasp")["job"];
    const bool stop = std::string_view(method) == "stop";
    const Json answer = client->Result(method, stop ? Json::object() : Json{{"id", id}});
    if (stop) {
      EXPECT_EQ(answer["job"], id);
      EXPECT_EQ(answer["begun"], false);
    }
    const Json record = client->Result("job.get", {{"id", id}});
    EXPECT_EQ(record["state"], "cancelled");
    EXPECT_EQ(record["start_tick"], Json());
    Step(5);
    EXPECT_EQ(client->Result("status")["state"], "idle");
  }
  const Json next = client->Result("grasp")["job"];  // nothing is in its way
  Step(5);
  EXPECT_EQ(client->Result("job.get", {{"id", next}})["state"], "running");
  EXPECT_EQ(client->Result("stop")["begun"], true);
}

TEST_F(Jobs, StepsAreExact) {
  Step(7);
  EXPECT_EQ(client->Result("status")["tick"], 7);
  Step(1003);
  EXPECT_EQ(client->Result("status")["tick"], 1010);
  EXPECT_EQ(client->Result("status")["time_s"], 1.010);
  EXPECT_EQ(client->Result("status")["paused"], true);
}

TEST_F(Jobs, AStepNeedsAStoppedClock) {
  EXPECT_EQ(client->Result("resume")["paused"], false);
  EXPECT_EQ(client->Error("step"), -32002);
  EXPECT_EQ(client->Result("pause")["paused"], true);
  const Json tick = client->Result("status")["tick"];
  EXPECT_EQ(client->Result("status")["tick"], tick);
  Step(1);
  EXPECT_EQ(client->Result("status")["tick"], tick.get<int>() + 1);
}

TEST_F(Jobs, AStepCanBeCancelled) {
  const Json job = client->Result("step", {{"ticks", 1'000'000'000}})["job"];
  EXPECT_EQ(client->Error("step"), -32001);
  EXPECT_EQ(client->Result("job.cancel", {{"id", job}})["state"], "cancelled");
  EXPECT_EQ(Wait(job)["state"], "cancelled");
  Step(1);
}

TEST_F(Jobs, WaitIsOvertakenByWhatComesAfterIt) {
  const Json job = client->Result("grasp")["job"];
  client->Send(
      Json({{"jsonrpc", "2.0"}, {"id", "wait"}, {"method", "job.wait"}, {"params", {{"id", job}}}})
          .dump() +
      "\n");
  EXPECT_TRUE(client->Ask("version").contains("result"));  // the wait blocks nothing
  Step(1);                                                 // it runs, so that its end takes a tick
  client->Result("job.cancel", {{"id", job}});
  client->Send(R"({"jsonrpc":"2.0","id":"step","method":"step","params":{"ticks":3}})"
               "\n");
  // Which of these two comes first is not promised.
  Json answer = client->Receive();
  if (answer["id"] == "step") answer = client->Receive();
  EXPECT_EQ(answer["id"], "wait");
  EXPECT_EQ(answer["result"]["state"], "cancelled") << answer.dump();
}

TEST_F(Jobs, WaitTimesOut) {
  const Json job = client->Result("grasp")["job"];
  const Json answer = client->Ask("job.wait", {{"id", job}, {"timeout_s", 0.01}});
  EXPECT_EQ(answer["error"]["code"], -32004);
  EXPECT_EQ(client->Result("job.get", {{"id", job}})["state"], "queued");
}

TEST_F(Jobs, AnEndAtTheMomentOfTheTimeoutIsAnsweredOnce) {
  // Each wait may end either way; steps take about 2 ms here. An answer that came twice would upset
  // the order of the answers and the count of waiting requests.
  for (int i = 0; i < 300; ++i) {
    const Json step = client->Result("step", {{"ticks", 40}})["job"];
    const int code = client->Error("job.wait", {{"id", step}, {"timeout_s", 1e-5 * (i + 1)}});
    ASSERT_TRUE(code == 0 || code == -32004) << code << " in round " << i;
    ASSERT_EQ(client->Error("job.wait", {{"id", step}}), 0) << "in round " << i;
  }
}

TEST_F(Jobs, AResetEndsThem) {
  const Json job = client->Result("grasp")["job"];
  Step(100);
  client->Result("reset");
  EXPECT_EQ(Wait(job)["state"], "cancelled");
  const Json queued = client->Result("grasp")["job"];
  client->Result("reset");
  const Json record = Wait(queued);
  EXPECT_EQ(record["state"], "cancelled");
  EXPECT_FALSE(record["error"].is_null());
  EXPECT_EQ(client->Error("grasp"), 0);
}

TEST_F(Jobs, WhatAHandThatHoldsNothingDoesNotHaveIsNull) {
  const auto none = [this] {
    const Json quality = client->Result("quality");
    for (const char* name : {"stability", "load_margin_n"})
      EXPECT_TRUE(quality[name].is_null()) << name << ": " << quality[name];
    for (const std::string measure : quality["measures"])
      EXPECT_TRUE(quality[measure].is_null()) << measure;
    for (const auto& [name, finger] : quality["fingers"].items())
      EXPECT_TRUE(finger["load_margin_without_n"].is_null()) << name;
    const Json truth = client->Result("truth");
    EXPECT_EQ(truth["fingers"].size(), 5u);
    for (const auto& [name, finger] : truth["fingers"].items())
      EXPECT_EQ(finger["manipulability"].is_null(), !finger["in_contact"]) << name;
    EXPECT_TRUE(client->Result("contacts")["object"]["p_WO_reference_m"].is_null());
  };
  Step(10);
  none();
  client->Result("grasp");
  Step(6000);
  EXPECT_TRUE(client->Result("contacts")["object"]["p_WO_reference_m"].is_array());
  EXPECT_TRUE(client->Result("quality")["load_margin_n"].is_number());
  client->Result("release");
  Step(3000);
  none();
}

TEST_F(Jobs, AnExplorationsRecordIsComplete) {
  const Json grasp = client->Result("grasp")["job"];
  Step(6000);
  ASSERT_EQ(Wait(grasp)["state"], "done");
  const Json job =
      client->Result("explore", {{"finger", "ring"}, {"seed", 4}, {"max_cycles", 300}})["job"];
  Step(12000);
  const Json record = Wait(job);
  for (const char* field :
       {"finger",         "criterion",  "converged",     "reason",    "cycles",
        "phi_initial",    "phi_final",  "path_length_m", "seed",      "phi_true_initial",
        "phi_true_final", "id",         "method",        "state",     "error",
        "progress",       "start_tick", "end_tick",      "started_s", "ended_s"})
    EXPECT_TRUE(record.contains(field)) << field;
  EXPECT_EQ(record["finger"], "ring");
  EXPECT_EQ(record["seed"], 4);
  EXPECT_EQ(record["start_tick"], 6000);
  EXPECT_EQ(record["started_s"], 6.0);
  EXPECT_FALSE(record["reason"].is_null());
  const Json quality = client->Result("quality");
  EXPECT_EQ(quality["fingers"].size(), 5u);
  // Five fingers hold: none may be an unset zero.
  EXPECT_GT(quality["load_margin_n"], 0);
  EXPECT_EQ(quality["measures"].size(), kNumMeasures);
  for (const std::string measure : quality["measures"]) EXPECT_GT(quality[measure], 0) << measure;
  const Json truth = client->Result("truth");
  for (const Json& contact : truth["contacts"])
    for (const char* field : {"link", "finger", "p_WC_m", "normal_W", "force_W_n", "depth_m"})
      EXPECT_TRUE(contact.contains(field)) << field;
  const Json plot = client->Result("plot", {{"name", "quality"}, {"file", "q.png"}});
  EXPECT_GT(std::filesystem::file_size(plot["path"].get<std::string>()), 1000u);
}

TEST_F(Jobs, ARotationIsStoppedIntoAHoldAndItsRecordIsComplete) {
  const Json grasp = client->Result("grasp")["job"];
  Step(6000);
  ASSERT_EQ(Wait(grasp)["state"], "done");
  // Any length of the axis will do.
  const Json job = client->Result("rotate", {{"continuous", true}, {"axis", {0, 0, -1e-3}}})["job"];
  Step(3000);
  EXPECT_EQ(client->Result("status")["state"], "rotating");
  EXPECT_EQ(client->Error("rotate", {{"turns", 1}}), -32001);
  client->Result("stop");
  Step(3000);
  EXPECT_EQ(client->Result("status")["state"], "holding");
  const Json record = Wait(job);
  for (const char* field : {"angle_rad", "turns", "gait_cycles", "regrasps", "dropped",
                            "max_position_error_m", "max_tilt_rad", "sim_time_s"})
    EXPECT_TRUE(record.contains(field)) << field;
  EXPECT_EQ(record["method"], "rotate");
  EXPECT_EQ(record["state"], "cancelled");
  EXPECT_EQ(record["dropped"], false);
  // Three seconds at 20 deg/s, pauses for regrasps included, turn by more than the first motion's
  // half step; and about the axis given, so with a positive sign.
  EXPECT_GT(record["angle_rad"].get<double>(), 0.1);
}

TEST_F(Jobs, AMovesRecordIsComplete) {
  const Json grasp = client->Result("grasp")["job"];
  Step(6000);
  ASSERT_EQ(Wait(grasp)["state"], "done");
  const Json job = client->Result(
      "move", {{"offset_m", {0, 0, 0.003}}, {"rotation_rad", {1e-157, 0, 0}}})["job"];
  EXPECT_EQ(client->Result("job.get", {{"id", job}})["offset_m"], Json({0, 0, 0.003}));  // queued
  Step(100);
  EXPECT_EQ(client->Result("status")["state"], "moving");
  const Json running = client->Result("job.get", {{"id", job}});
  EXPECT_EQ(running["end"], Json());
  EXPECT_EQ(running["reached"], false);
  EXPECT_EQ(client->Error("move", {{"offset_m", {0, 0, 0.003}}}), -32001);
  Step(3000);
  const Json record = Wait(job);
  EXPECT_EQ(record["method"], "move");
  EXPECT_EQ(record["state"], "done");
  EXPECT_EQ(record["reached"], true);
  EXPECT_EQ(record["end"], "reached");
  EXPECT_EQ(record["end_finger"], Json());
  EXPECT_EQ(record["offset_m"], Json({0, 0, 0.003}));
  EXPECT_EQ(record["rotation_rad"], Json({0, 0, 0}));
  EXPECT_NEAR(record["achieved_offset_m"][2].get<double>(), 0.003, 1e-3);
  for (const char* field :
       {"achieved_rotation_rad", "max_position_error_m", "max_rotation_error_rad", "sim_time_s"})
    EXPECT_TRUE(record.contains(field)) << field;
}

TEST_F(Jobs, TheListKeepsTheLast256) {
  for (int i = 0; i < 260; ++i) Step(1);
  const Json jobs = client->Result("job.list")["jobs"];
  ASSERT_EQ(jobs.size(), 256u);
  EXPECT_EQ(jobs.front()["id"], 5);
  EXPECT_EQ(jobs.back()["id"], 260);
  EXPECT_EQ(client->Error("job.get", {{"id", 4}}), -32003);
}

TEST_F(Jobs, TooManyWaitingCommandsAreBusyAndTheClockStillObeys) {
  int accepted = 0;
  while (client->Error("noise.set", {{"position_m", 0.001}}) == 0 && accepted < 1000) ++accepted;
  EXPECT_EQ(accepted, 400);
  EXPECT_GT(static_cast<std::size_t>(accepted), ParameterTable().size());  // all fit at once
  Step(1);
  EXPECT_EQ(client->Error("noise.set", {{"position_m", 0.001}}), 0);
}

/// Runs a script and returns the hash at its end; with a watcher, all topics are streamed
/// meanwhile.
std::string HashOfScript(const std::string& socket, bool watched) {
  TestClient client(socket);
  // Parameters outlive a reset: begin with the same one each time.
  client.Result("param.set", {{"name", "object.friction"}, {"value", 0.8}});
  client.Result("reset", {{"seed", 9}});
  std::unique_ptr<TestClient> watcher;
  if (watched) {
    watcher = std::make_unique<TestClient>(socket);
    for (const char* topic : {"status", "contacts", "quality", "joints", "truth", "events"})
      watcher->Send(Json({{"jsonrpc", "2.0"},
                          {"method", "subscribe"},
                          {"params", {{"topic", topic}, {"rate_hz", 100}}}})
                        .dump() +
                    "\n");
  }
  client.Result("grasp");
  client.Result("job.wait", {{"id", client.Result("step", {{"ticks", 2000}})["job"]}});
  client.Result("param.set", {{"name", "object.friction"}, {"value", 0.7}});
  client.Result("job.wait",
                {{"id", client.Result("step", {{"ticks", watched ? 1000 : 400}})["job"]}});
  if (!watched) client.Result("job.wait", {{"id", client.Result("step", {{"ticks", 600}})["job"]}});
  EXPECT_EQ(client.Result("status")["tick"], 3000);
  return client.Result("status")["state_hash"];
}

TEST(JobRecord, PhiIsNullUntilItIsSeen) {
  JobRecord job;
  job.method = JobMethod::kExplore;
  const auto is_null = [&job](const char* phi) {
    return JobJson(job, HandModel(), 1e-3)[phi].is_null();
  };
  for (const char* phi : {"phi_initial", "phi_final", "phi_true_initial", "phi_true_final"})
    EXPECT_TRUE(is_null(phi)) << phi;
  job.explore.phi_initial = 0.7;  // its finger slides
  EXPECT_FALSE(is_null("phi_initial"));
  EXPECT_TRUE(is_null("phi_final"));
}

TEST_F(Jobs, TheSameScriptGivesTheSameBitsWatchedOrNot) {
  client.reset();
  EXPECT_EQ(HashOfScript(config.socket, false), HashOfScript(config.socket, true));
}

}  // namespace
}  // namespace regrasp::test
