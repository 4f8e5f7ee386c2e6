// The pieces between the threads.

#include <gtest/gtest.h>

#include <thread>

#include "daemon/loop/pacing.h"
#include "daemon/loop/ring.h"
#include "daemon/output/history.h"
#include "daemon/requests/jobs.h"
#include "daemon/server/wake.h"

namespace regrasp {
namespace {

TEST(Ring, RefusesWhenFullAndKeepsOrder) {
  Ring<int, 4> ring;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.Push(i));
  EXPECT_FALSE(ring.Push(4));
  for (int i = 0, value = -1; i < 4; ++i) {
    EXPECT_TRUE(ring.Pop(&value));
    EXPECT_EQ(value, i);
  }
  int none = 0;
  EXPECT_FALSE(ring.Pop(&none));
}

TEST(Ring, CarriesEverythingBetweenThreads) {
  Ring<int, 8> ring;
  Wake wake;
  constexpr int kCount = 20'000;
  std::thread producer([&] {
    for (int i = 0; i < kCount;) {
      if (ring.Push(i)) ++i;
      wake.Notify();
    }
  });
  int expected = 0;
  while (expected < kCount) {
    wake.WaitUntil({});  // a lost wake-up would hang here
    wake.Clear();
    for (int value = 0; ring.Pop(&value); ++expected) ASSERT_EQ(value, expected);
  }
  producer.join();
}

TEST(Pacing, KeepsStepWithTheWallClockAndForgetsStalls) {
  using namespace std::chrono_literals;
  Pacing pacing(1e-3, 0.5);  // a tick of 1 ms every 2 ms
  const Pacing::Clock::time_point start{};
  pacing.Restart(start);
  EXPECT_FALSE(pacing.Due(start).has_value());
  for (int i = 0; i < 1000; ++i) pacing.Ticked();
  EXPECT_EQ(*pacing.Due(start), start + 2s);
  EXPECT_FALSE(pacing.Due(start + 10s).has_value());  // late: due now
  pacing.Ticked();
  EXPECT_EQ(*pacing.Due(start + 10s), start + 10s + 2ms);  // and no burst afterwards
  Pacing unpaced(1e-3, kMaxSpeed);
  unpaced.Ticked();
  EXPECT_FALSE(unpaced.Due(start).has_value());
}

TEST(History, ThinsWhatIsOlderThanAMinute) {
  History history;
  Frame frame;
  for (int tick = 0; tick <= 700'000; tick += 10) {
    frame.tick = tick;
    frame.time_s = tick * 1e-3;
    history.Add(frame);
  }
  EXPECT_EQ(history.size(), History::kFine + History::kCoarse);
  const auto all = history.Frames(0);
  // 2700 frames at 5 Hz end where 3000 frames at 50 Hz begin.
  EXPECT_NEAR(all.front()->time_s, 700.0 - 60.0 - 540.0, 0.5);
  EXPECT_EQ(all.back()->tick, 700'000);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LT(all[i - 1]->tick, all[i]->tick);
  EXPECT_EQ(history.Frames(1.0).size(), 51u);
  history.Clear();
  EXPECT_TRUE(history.Frames(0).empty());
}

TEST(History, KeepsTheLastTwoExplorationsAcrossAReset) {
  History history;
  const auto run = [&](int job, SessionState state, int frames, bool slides = true) {
    Frame frame;
    frame.job.id = job;
    frame.state = state;
    frame.exploration.active = slides;
    for (int i = 0; i < frames; ++i) {
      frame.time_s += History::kFinePeriod;
      if (history.Add(frame))
        history.DescribeExploration("object of " + std::to_string(job),
                                    "changed in " + std::to_string(job));
    }
    history.Clear();
  };
  run(1, SessionState::kExploring, 5);
  run(2, SessionState::kRotating, 5);  // explorations of a gait do not count
  EXPECT_EQ(history.Explorations().size(), 1u);
  run(3, SessionState::kExploring, 7);
  run(4, SessionState::kExploring, 9);
  run(5, SessionState::kExploring, 6, false);  // refused before its finger slid
  const auto kept = history.Explorations();
  ASSERT_EQ(kept.size(), History::kExplorations);
  EXPECT_EQ(kept[0].frames.size(), 7u);
  EXPECT_EQ(kept[1].frames.size(), 9u);
  EXPECT_EQ(kept[1].frames.front()->job.id, 4);
  EXPECT_EQ(kept[0].object, "object of 3");
  EXPECT_EQ(kept[1].changed, "changed in 4");
}

TEST(JobTable, IgnoresNewsOlderThanTheEnd) {
  JobTable jobs;
  JobRecord job = jobs.Add(JobMethod::kGrasp);
  int calls = 0;
  jobs.Wait(job.id, [&](const JobRecord& ended) {
    ++calls;
    EXPECT_EQ(ended.state, JobState::kDone);
  });
  job.state = JobState::kRunning;
  job.start_tick = 3;
  jobs.Update(job);
  EXPECT_EQ(calls, 0);
  const JobRecord running = job;
  job.state = JobState::kDone;
  jobs.Update(job);
  jobs.Update(running);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(jobs.Find(job.id)->state, JobState::kDone);
  EXPECT_EQ(jobs.Unfinished(), nullptr);
}

}  // namespace
}  // namespace regrasp
