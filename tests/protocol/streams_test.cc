// Subscriptions, and clients that do not behave.

#include <gtest/gtest.h>

#include "tests/protocol/daemon_fixture.h"

namespace regrasp::test {
namespace {

class Streams : public DaemonTest {};

TEST_F(Streams, SamplesAreNumberedAndCarryTheTopic) {
  config.paused = false;
  Start();
  const auto client = Connect();
  const Json sub = client->Result("subscribe", {{"topic", "status"}, {"rate_hz", 100}})["sub"];
  double last_t = -1;
  for (int i = 1; i <= 5; ++i) {
    const Json message = client->Receive();
    EXPECT_EQ(message["method"], "event");
    EXPECT_FALSE(message.contains("id"));
    const Json& sample = message["params"];
    EXPECT_EQ(sample["sub"], sub);
    EXPECT_EQ(sample["seq"], i);
    EXPECT_EQ(sample["dropped"], 0);
    EXPECT_TRUE(sample.contains("state_hash"));
    EXPECT_GT(sample["t_s"].get<double>(), last_t);  // never the same frame twice
    last_t = sample["t_s"];
  }
}

TEST_F(Streams, EndWithUnsubscribe) {
  config.paused = false;
  Start();
  const auto client = Connect();
  const Json sub = client->Result("subscribe", {{"topic", "truth"}, {"rate_hz", 100}})["sub"];
  client->Receive();
  client->Send(
      Json({{"jsonrpc", "2.0"}, {"id", "u"}, {"method", "unsubscribe"}, {"params", {{"sub", sub}}}})
          .dump() +
      "\n");
  Json message;
  std::int64_t samples = 1;
  while (!(message = client->Receive()).contains("id")) ++samples;
  EXPECT_EQ(message["result"]["seq"], samples);
  EXPECT_TRUE(client->Ask("version").contains("result"));  // the next line, so nothing came between
  EXPECT_EQ(client->Error("unsubscribe", {{"sub", sub}}), -32003);
}

TEST_F(Streams, EventsComeInOrderAndOnlyWhenAskedFor) {
  Start();
  const auto client = Connect(), other = Connect();
  client->Result("subscribe", {{"topic", "events"}});
  const Json job = other->Result("grasp")["job"];
  other->Result("job.wait", {{"id", other->Result("step", {{"ticks", 1}})["job"]}});
  const Json first = client->Receive()["params"], second = client->Receive()["params"];
  EXPECT_EQ(first["kind"], "job_started");
  EXPECT_EQ(first["job"], job);
  EXPECT_EQ(first["seq"], 1);
  EXPECT_EQ(second["kind"], "state");
  EXPECT_EQ(second["state"], "grasping");
  EXPECT_EQ(second["seq"], 2);
  EXPECT_TRUE(other->Ask("version").contains("result"));
}

TEST_F(Streams, AreLimitedPerConnection) {
  Start();
  const auto client = Connect();
  for (int i = 0; i < 32; ++i) EXPECT_EQ(client->Error("subscribe", {{"topic", "events"}}), 0);
  EXPECT_EQ(client->Error("subscribe", {{"topic", "events"}}), -32001);
}

TEST_F(Streams, AClientThatDoesNotReadIsEvictedAndTheOthersLiveOn) {
  limits.max_stall = std::chrono::milliseconds(200);
  Start();
  const auto deaf = Connect(), other = Connect();
  // 15 KiB of answer for 50 bytes of question: past the kernel's buffer and the daemon's.
  const std::string question = R"({"jsonrpc":"2.0","id":1,"method":"describe"})"
                               "\n";
  bool gone = false;
  for (int i = 0; i < 10'000 && !gone; ++i) gone = !deaf->Send(question);
  EXPECT_TRUE(gone);
  EXPECT_EQ(other->Error("status"), 0);
}

/// Makes an event.
void MakeEvent(TestClient* client) { client->Result("noise.set", {{"position_m", 0.001}}); }

TEST_F(Streams, AClientThatLeavesEventsUnreadIsEvicted) {
  limits.max_output_bytes = 64 * 1024;
  config.paused = false;
  Start();
  const auto deaf = Connect(), other = Connect();
  deaf->Result("subscribe", {{"topic", "events"}});
  // The kernel takes some 200 KiB, an event has 150 bytes.
  int events = 0;
  for (; events < 20'000 && other->Result("status")["clients"] == 2; ++events)
    MakeEvent(other.get());
  EXPECT_LT(events, 20'000);
  EXPECT_TRUE(deaf->ReachesEnd());
}

TEST_F(Streams, AClientThatReadsLateGetsEveryAnswerInOrder) {
  Start();
  const auto client = Connect(), other = Connect();
  // 4 MiB of answers: the daemon stops listening, so the questions go out from a thread.
  constexpr int kCount = 300;
  std::thread asking([&] {
    for (int i = 0; i < kCount; ++i)
      client->Send(R"({"jsonrpc":"2.0","id":)" + std::to_string(i) +
                   R"(,"method":"describe"})"
                   "\n");
  });
  EXPECT_EQ(other->Error("status"), 0);
  for (int i = 0; i < kCount; ++i) ASSERT_EQ(client->Receive()["id"], i);
  asking.join();
  EXPECT_EQ(client->Error("status"), 0);
}

TEST_F(Streams, ABatchOfLongAnswersIsAnsweredWhole) {
  config.paused = false;
  Start();
  const auto client = Connect();
  for (int i = 0; i < 1000; ++i) MakeEvent(client.get());
  Json batch = Json::array();
  for (int i = 0; i < 32; ++i)
    batch.push_back(
        {{"jsonrpc", "2.0"}, {"id", i}, {"method", "events"}, {"params", {{"count", 1000}}}});
  client->Send(batch.dump() + "\n");
  const Json answers = client->Receive();
  ASSERT_EQ(answers.size(), 32u);
  for (int i = 0; i < 32; ++i) {
    EXPECT_EQ(answers[i]["id"], i);
    EXPECT_EQ(answers[i]["result"]["events"].size(), 1000u);
  }
}

TEST_F(Streams, AClientWithoutProgressIsEvicted) {
  limits.max_stall = std::chrono::milliseconds(40);
  limits.max_output_bytes = 1u << 30;  // only the stall can end it
  Start();
  const auto deaf = Connect(), other = Connect();
  std::string questions;
  for (int i = 0; i < 200; ++i)
    questions += R"({"jsonrpc":"2.0","id":1,"method":"describe"})"
                 "\n";
  EXPECT_TRUE(deaf->Send(questions));
  // Two clients until the stalled one is evicted; the fixture's 60 s bound this loop.
  while (other->Result("status")["clients"] != 1)
    if (HasFailure()) return;
  EXPECT_TRUE(deaf->ReachesEnd());
}

TEST_F(Streams, TooManyClientsAreTurnedAway) {
  config.max_clients = 2;
  Start();
  const auto first = Connect();
  auto second = Connect();
  EXPECT_EQ(first->Error("status"), 0);
  EXPECT_EQ(second->Error("status"), 0);
  const auto third = Connect();
  EXPECT_EQ(third->Receive()["error"]["code"], -32010);
  EXPECT_TRUE(third->ReachesEnd());
  second.reset();
  while (first->Result("status")["clients"] != 1)
    if (HasFailure()) return;
  EXPECT_EQ(Connect()->Error("status"), 0);
}

}  // namespace
}  // namespace regrasp::test
