// Requests to a real daemon: good and bad, and what they change.

#include <gtest/gtest.h>

#include "tests/protocol/daemon_fixture.h"

// OpenCV asks GDAL when it writes a picture; GDAL takes two locks of its own in either order, by
// one thread.
extern "C" const char* __tsan_default_suppressions() { return "deadlock:libgdal"; }

namespace regrasp::test {
namespace {

class Requests : public SteppedDaemonTest {};

TEST_F(Requests, AnswerWithTheRightCode) {
  struct Case {
    std::string method;
    Json params;
    int code;
  };
  const std::vector<Case> cases = {
      {"status", {}, 0},
      {"statu", {}, -32601},
      {"", {}, -32601},
      {"record.pause", {}, -32601},  // no such method
      {"status", {{"x", 1}}, -32602},
      {"explore", {}, -32602},
      {"explore", {{"finger", "rign"}}, -32602},
      {"explore", {{"finger", 3}}, -32602},
      {"explore", {{"finger", "ring"}, {"seed", -1}}, -32602},
      {"explore", {{"finger", "ring"}, {"seed", 1.5}}, -32602},
      {"explore",
       {{"finger", "ring"}, {"seed", 9007199254740993}},
       -32602},  // a double would round it
      {"explore", {{"finger", "ring"}, {"max_cycles", 0}}, -32602},
      {"explore", {{"finger", "ring"}, {"criterion", "best"}}, -32602},
      {"explore", {{"finger", "ring"}}, -32002},        // nothing is held
      {"move", {{"offset_m", {0, 0, 0.005}}}, -32002},  // nothing is held
      {"move", {{"rotation_rad", {0, 0, 0.1}}}, -32002},
      {"move", {}, -32602},
      {"move", {{"offset_m", {0, 0, 0}}, {"rotation_rad", {0, 0, 0}}}, -32602},
      // Too short to have a direction.
      {"move", {{"offset_m", {1e-170, 0, 0}}, {"rotation_rad", {0, 1e-157, 0}}}, -32602},
      {"move", {{"offset_m", {0, 0, 0.0501}}}, -32602},
      {"move", {{"offset_m", {0.04, 0.04, 0}}}, -32602},  // each in range, the length is not
      {"move", {{"rotation_rad", {2, 2, 2}}}, -32602},
      {"move", {{"rotation_rad", {0, 0, 3.2}}}, -32602},
      {"move", {{"offset_m", {0, 0.005}}}, -32602},
      {"move", {{"offset_m", 0.005}}, -32602},
      {"move", {{"offset_m", {0, 0, nullptr}}}, -32602},
      {"move", {{"offset_m", {0, 0, "5"}}}, -32602},
      {"move", {{"offset", {0, 0, 0.005}}}, -32602},
      {"release", {}, -32002},
      {"rotate", {{"turns", 1}}, -32002},  // nothing is held
      {"rotate", {}, -32602},
      {"rotate", {{"turns", 1}, {"angle_rad", 1}}, -32602},
      {"rotate", {{"turns", 1}, {"continuous", true}}, -32602},
      {"rotate", {{"continuous", false}}, -32602},
      {"rotate", {{"turns", 0}}, -32602},
      {"rotate", {{"angle_rad", 1}, {"axis", {0, 0, 0}}}, -32602},
      {"rotate", {{"angle_rad", 1}, {"axis", {0, 1}}}, -32602},
      {"rotate", {{"angle_rad", 1}, {"axis_W", {0, 0, 1}}}, -32602},
      {"rotate", {{"angle_rad", 1}, {"speed_rad_s", 0}}, -32602},
      {"plot", {{"name", "comparison"}}, -32002},  // there were no two explorations
      {"push", {{"force_n", {1, 0, 0}}}, -32002},
      {"push", {{"force_n", {1, 0}}}, -32602},
      {"push", {{"force_n", {1, 0, 1e9}}}, -32602},
      {"push", {{"force_n", "up"}}, -32602},
      {"step", {{"ticks", 0}}, -32602},
      {"step", {{"ticks", "3"}}, -32602},
      {"noise.set", {{"preset", "loud"}}, -32602},
      {"noise.set", {{"position_m", -1}}, -32602},
      {"noise.set", {{"dropout_gap_s", 0.0001}}, -32602},
      {"noise.set", {{"position_m", nullptr}}, -32602},
      {"param.get", {{"name", "object.friction"}}, 0},
      {"param.get", {{"name", "object.frictoin"}}, -32003},
      {"param.set", {{"name", "nothing.like.this"}, {"value", 1}}, -32003},
      {"param.set", {{"name", "object.friction"}}, -32602},
      {"param.set", {{"name", "object.friction"}, {"value", 7}}, -32602},
      {"param.set", {{"name", "object.friction"}, {"value", {1, 1, 1}}}, -32602},
      {"param.set", {{"name", "gravity"}, {"value", 1}}, -32602},
      {"param.set", {{"name", "gravity"}, {"value", {0, -9.81, 0}}}, 0},
      {"reset", {{"object", "no_such_object"}}, -32003},
      {"reset", {{"object", "/etc/passwd"}}, -32003},
      {"job.get", {{"id", 999}}, -32003},
      {"job.get", {{"id", "1"}}, -32602},
      {"job.wait", {{"id", 999}}, -32003},
      {"job.cancel", {{"id", 999}}, -32003},
      {"subscribe", {{"topic", "weather"}}, -32602},
      {"subscribe", {{"topic", "status"}, {"rate_hz", 1e6}}, -32602},
      {"unsubscribe", {{"sub", 5}}, -32003},
      {"plot", {{"name", "quality"}, {"file", "../escape.png"}}, -32602},
      {"plot", {{"name", "quality"}, {"file", "/tmp/escape.png"}}, -32602},
      {"plot", {{"name", "quality"}, {"file", ".hidden.png"}}, -32602},
      {"plot", {{"name", "quality"}, {"file", "program.sh"}}, -32602},
      {"plot", {{"name", "portrait"}}, -32602},
      {"hello", {{"protocol", {1, 1}}}, 0},
      {"hello", {{"protocol", {2, 9}}}, -32012},
      {"hello", {{"protocol", 1}}, -32602},
      {"describe", {{"method", "explore"}}, 0},
      {"describe", {{"method", "explode"}}, -32003},
  };
  for (const Case& c : cases)
    EXPECT_EQ(client->Error(c.method, c.params.is_null() ? Json::object() : c.params), c.code)
        << c.method << " " << c.params.dump();
}

TEST_F(Requests, RefusedOnesChangeNothing) {
  const Json before = client->Result("param.get");
  const std::string hash = client->Result("status")["state_hash"];
  client->Error("param.set", {{"name", "object.friction"}, {"value", 7}});
  client->Error("noise.set", {{"position_m", 0.002}, {"normal_rad", -1}});
  client->Error("grasp", {{"force", 3}});
  client->Error("move", {{"offset_m", {0.04, 0.04, 0}}});
  EXPECT_EQ(client->Result("param.get"), before);
  EXPECT_EQ(client->Result("noise.get")["preset"], "paper");
  EXPECT_EQ(client->Result("status")["state_hash"], hash);
  EXPECT_TRUE(client->Result("job.list")["jobs"].empty());
}

TEST_F(Requests, ErrorsNameParameterHintAndAllowedValues) {
  const Json error = client->Ask("explore", {{"finger", "rign"}})["error"];
  EXPECT_EQ(error["data"]["param"], "finger");
  EXPECT_NE(
      error["message"].get<std::string>().find("allowed are first, middle, ring, little, thumb"),
      std::string::npos)
      << error["message"];
  EXPECT_EQ(error["data"]["hint"], "did you mean 'ring'?");
  EXPECT_EQ(error["data"]["allowed"].size(), 5u);
  const Json move = client->Ask("move", {{"offset_m", {0.04, 0.03, 0.04}}})["error"];
  EXPECT_EQ(move["message"], "offset_m of length 0.0640312 m is too long");
  EXPECT_EQ(move["data"]["param"], "offset_m");
  EXPECT_EQ(move["data"]["hint"], "allowed: at most 0.05 m");
  EXPECT_EQ(client->Ask("explore", {{"figner", "ring"}})["error"]["data"]["hint"],
            "did you mean 'finger'?");
  EXPECT_EQ(client->Ask("stauts")["error"]["data"]["hint"], "did you mean 'status'?");
}

TEST_F(Requests, NotificationsAreObeyedInSilence) {
  client->Send(R"({"jsonrpc":"2.0","method":"noise.set","params":{"preset":"off"}})"
               "\n");
  client->Send(R"({"jsonrpc":"2.0","method":"no.such.method"})"
               "\n");
  client->Send(R"({"jsonrpc":"2.0","method":"step","params":{"ticks":-4}})"
               "\n");
  EXPECT_EQ(client->Result("noise.get")["preset"], "off");  // the first answer that comes
}

TEST_F(Requests, ABatchIsAnsweredInOneArrayWithoutItsNotifications) {
  client->Send(
      R"([{"jsonrpc":"2.0","id":"a","method":"version"},{"jsonrpc":"2.0","method":"version"},)"
      R"({"jsonrpc":"2.0","id":7,"method":"nope"},3])"
      "\n");
  const Json answers = client->Receive();
  ASSERT_EQ(answers.size(), 3u) << answers.dump();
  EXPECT_EQ(answers[0]["id"], "a");
  EXPECT_TRUE(answers[0].contains("result"));
  EXPECT_EQ(answers[1]["id"], 7);
  EXPECT_EQ(answers[1]["error"]["code"], -32601);
  EXPECT_EQ(answers[2]["id"], Json());
  EXPECT_EQ(answers[2]["error"]["code"], -32600);
  // Only notifications: no answer at all.
  client->Send(R"([{"jsonrpc":"2.0","method":"version"}])"
               "\n");
  EXPECT_TRUE(client->Ask("version").contains("result"));
}

TEST_F(Requests, LinesMayEndWithCarriageReturnAndComeInPieces) {
  client->Send("\r\n\n  \n{\"jsonrpc\":\"2.0\",\"id\":1,");
  client->Send("\"method\":\"version\"}\r");
  client->Send(
      "\n{\"jsonrpc\":\"2.0\",\"id\":2,\"method\":\"version\"}\n{\"jsonrpc\":\"2.0\",\"id\":3,");
  EXPECT_EQ(client->Receive()["id"], 1);
  EXPECT_EQ(client->Receive()["id"], 2);
  client->Send("\"method\":\"version\"}\n");
  EXPECT_EQ(client->Receive()["id"], 3);
}

TEST_F(Requests, TheLastLineNeedsNoLineEnd) {
  client->Send(R"({"jsonrpc":"2.0","id":1,"method":"version"})");
  client->FinishSending();
  EXPECT_TRUE(client->Receive().contains("result"));
  EXPECT_TRUE(client->ReachesEnd());
}

TEST_F(Requests, AnOverlongLineIsAnsweredAndTheConnectionClosed) {
  // Far more than fits into socket buffers: the answer must survive that the client is still
  // writing.
  std::thread writer([this] {
    client->Send(std::string(4 * 1024 * 1024, 'x'));
    client->FinishSending();
  });
  const Json answer = client->Receive();
  EXPECT_EQ(answer["error"]["code"], -32011);
  EXPECT_EQ(answer["id"], Json());
  EXPECT_TRUE(client->ReachesEnd());
  writer.join();
  EXPECT_EQ(Connect()->Error("status"), 0);
}

TEST_F(Requests, EachConnectionIsAnsweredInOrder) {
  std::string lines;
  for (int i = 0; i < 300; ++i) {
    const char* method = i % 3 == 0 ? "noise.set" : i % 3 == 1 ? "status" : "nope";
    const Json params = i % 3 == 0 ? Json{{"position_m", 1e-6 * i}} : Json::object();
    lines +=
        Json({{"jsonrpc", "2.0"}, {"id", i}, {"method", method}, {"params", params}}).dump() + "\n";
  }
  std::thread writer([&] { client->Send(lines); });
  for (int i = 0; i < 300; ++i) EXPECT_EQ(client->Receive()["id"], i);
  writer.join();
}

TEST_F(Requests, DescribeHoldsTheWholeTable) {
  const Json all = client->Result("describe");
  EXPECT_EQ(all["methods"].size(), MethodTable().size());
  for (const Json& method : all["methods"])
    for (const Json& param : method["params"])
      EXPECT_EQ(param["type"] == "name", param.contains("values"))
          << method["name"] << param["name"];
}

TEST_F(Requests, AllStatusFieldsExist) {
  const Json status = client->Result("status");
  for (const char* field :
       {"version", "state_hash", "state", "paused", "tick", "time_s", "real_time_factor", "seed",
        "hand", "object", "job", "noise", "clients"})
    EXPECT_TRUE(status.contains(field)) << field;
  EXPECT_EQ(status["state_hash"].get<std::string>().size(), 16u);
  EXPECT_EQ(status["state"], "idle");
  EXPECT_EQ(status["clients"], 1);
}

TEST_F(Requests, WhatIsSetIsReadBackAtOnceAndAppliedAtTheNextTick) {
  client->Result("param.set", {{"name", "object.friction"}, {"value", 0.5}});
  EXPECT_EQ(client->Result("param.get", {{"name", "object.friction"}})["value"], 0.5);
  EXPECT_EQ(client->Result("truth")["object"]["friction"], 0.8);  // paused: not yet
  const Json step = client->Result("step", {{"ticks", 1}});
  client->Result("job.wait", {{"id", step["job"]}});
  EXPECT_EQ(client->Result("truth")["object"]["friction"], 0.5);
  const Json events = client->Result("events")["events"];
  EXPECT_EQ(events.back()["kind"], "parameter");
}

TEST_F(Requests, ResetActsAtOnceAndKeepsParametersAndNoise) {
  client->Result("reset");  // its answer comes after the first frame there is
  const std::string fresh = client->Result("status")["state_hash"];
  const Json step = client->Result("step", {{"ticks", 25}});
  client->Result("job.wait", {{"id", step["job"]}});
  EXPECT_NE(client->Result("status")["state_hash"], fresh);
  client->Result("reset");
  const Json status = client->Result("status");
  EXPECT_EQ(status["tick"], 0);
  EXPECT_EQ(status["state_hash"], fresh);  // same seed, same state

  client->Result("noise.set", {{"preset", "fine"}});
  client->Result("param.set", {{"name", "object.friction"}, {"value", 0.4}});
  client->Result("reset", {{"seed", 2}});
  EXPECT_EQ(client->Result("status")["seed"], 2);
  EXPECT_NE(client->Result("status")["state_hash"], fresh);
  EXPECT_EQ(client->Result("truth")["object"]["friction"], 0.4);
  EXPECT_EQ(client->Result("noise.get")["preset"], "fine");
  client->Result("reset", {{"object", "sphere_45mm"}});
  EXPECT_EQ(client->Result("status")["object"], "sphere_45mm");
}

TEST_F(Requests, ResetWarnsOfAnOverlapWhereGraspRefuses) {
  client->Result("param.set", {{"name", "start.object_sigma_m"}, {"value", 0.015}});
  Step(1);
  int refused = 0;
  for (int seed = 1; seed <= 12; ++seed) {
    const Json reset = client->Result("reset", {{"seed", seed}});
    const bool warned = !reset["warnings"].empty();
    EXPECT_EQ(client->Result("status")["warnings"], reset["warnings"]);
    const Json job = client->Result("grasp")["job"];
    Step(1);
    const Json record = client->Result("job.get", {{"id", job}});
    EXPECT_EQ(record["state"] == "failed", warned) << record.dump() << reset.dump();
    refused += warned;
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 12);
}

TEST_F(Requests, ShutdownAnswersThenClosesAndRemovesTheSocket) {
  EXPECT_EQ(client->Result("shutdown")["stopping"], true);
  EXPECT_TRUE(client->ReachesEnd());
  thread.join();
  EXPECT_FALSE(std::filesystem::exists(config.socket));
  daemon.reset();
}

}  // namespace
}  // namespace regrasp::test
