// Same commands, same bits; what will act is in the hash; a tick allocates nothing.

#include <gtest/gtest.h>

#include <vector>

#include "tests/physics/malloc_counter.h"
#include "tests/physics/session_run.h"

namespace regrasp {
namespace {

using Kind = Verdict::Kind;

/// Everything that can happen, over 20 s.
std::vector<std::uint64_t> EventfulRun(std::uint64_t seed, bool watched) {
  SessionRun run(seed);
  std::vector<std::uint64_t> hashes;
  Frame frame;
  run.Give(CommandType::kGrasp);
  for (int tick = 0; tick < 20000; ++tick) {
    if (tick == 6000) run.Explore(2, 5, 3000);
    if (tick == 8000)
      run.Give(CommandType::kNoise, [](Command* c) { c->noise = NoisePreset("fine").value(); });
    if (tick == 14000) run.Push({0.3, 0, 0}, 0.1);
    if (tick == 15000) run.Set("gravity", {0, 6, 7.76});
    if (tick == 16000) run.Explore(4, 6, 2000);
    run.Tick();
    if (watched && tick % 7 == 0) run.session.Snapshot(&frame, tick % 2 == 0);
    if (tick % 1000 == 999) hashes.push_back(run.session.StateHash());
  }
  return hashes;
}

TEST(Session, SameSeedAndCommandsSameBitsWatchedOrNot) {
  const auto one = EventfulRun(3, false), again = EventfulRun(3, true),
             other = EventfulRun(4, false);
  ASSERT_EQ(one.size(), 20u);
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k], again[k]) << "after " << k + 1 << " s";
    EXPECT_NE(one[k], other[k]) << "after " << k + 1 << " s";
  }
  for (std::size_t k = 1; k < one.size(); ++k) EXPECT_NE(one[k], one[k - 1]);
}

// What differs now and will act later differs in the hash now.
TEST(Session, HashSeesEveryNumberThatWillActLater) {
  const auto After = [](const std::function<void(SessionRun*)>& change) {
    SessionRun run;
    EXPECT_TRUE(run.Grasp());
    change(&run);
    return run.session.StateHash();
  };
  const std::uint64_t plain = After([](SessionRun*) {});
  EXPECT_EQ(plain, After([](SessionRun*) {}));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Set("object.friction", 0.7); }));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Set("object.mass_kg", 0.09); }));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Set("gravity", {0, 0, 9}); }));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Set("control.grip_force", 1.1); }));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Set("exploration.eta", 4e-4); }));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Push({0.1, 0, 0}, 0.1); }));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Explore(0); }));
  EXPECT_NE(plain, After([](SessionRun* run) { run->Give(CommandType::kRelease); }));
  EXPECT_NE(plain, After([](SessionRun* run) {
              run->Give(CommandType::kNoise, [](Command* c) { c->noise = NoiseLevels(); });
            }));
  const std::uint64_t explore = After([](SessionRun* run) { run->Explore(0, 1); });
  EXPECT_NE(explore, After([](SessionRun* run) { run->Explore(1, 1); }));
  EXPECT_NE(explore, After([](SessionRun* run) { run->Explore(0, 2); }));
  EXPECT_NE(explore, After([](SessionRun* run) { run->Explore(0, 1, 500); }));
}

TEST(Session, TicksAllocateNothing) {
  if (!CountsAllocations()) GTEST_SKIP() << "a sanitizer owns malloc";
  Session session(ShadowConfig());
  Command command;
  std::int64_t job = 0;
  const auto Give = [&](CommandType type) {
    command.type = type;
    command.job = ++job;
    command.max_cycles = 2000;
    return session.Apply(command).kind == Kind::kAllowed;
  };
  Frame frame;
  const auto Allocations = [&](int ticks) {
    const long before = AllocationCount();
    for (int k = 0; k < ticks; ++k) {
      session.Tick();
      session.TakeEvents();
      session.TakeFinishedJobs();
      session.Snapshot(&frame, true);
    }
    return AllocationCount() - before;
  };
  session.Tick();  // the first tick may set up what the physics keeps
  EXPECT_EQ(Allocations(100), 0) << "idle";
  ASSERT_TRUE(Give(CommandType::kGrasp));
  // The first contact of a world's life makes ODE allocate one block of 16 KB, which it keeps.
  EXPECT_LE(Allocations(6000), 1) << "grasping";
  ASSERT_EQ(session.state(), SessionState::kHolding);
  EXPECT_EQ(Allocations(1000), 0) << "holding";
  for (command.finger = 0; command.finger < 5; ++command.finger) {
    ASSERT_TRUE(Give(CommandType::kExplore));
    long allocations = 0;
    for (int s = 0; s < 15 && session.job_running(); ++s) allocations += Allocations(1000);
    EXPECT_EQ(allocations, 0) << "exploring with finger " << command.finger;
    ASSERT_EQ(session.state(), SessionState::kHolding);
  }
  ASSERT_TRUE(Give(CommandType::kRelease));
  EXPECT_EQ(Allocations(600), 0) << "releasing";
}

/// After so many a measure that is spread over ticks has been computed once: with an empty hand.
}  // namespace
}  // namespace regrasp
