// Explorations in a whole session, by the truth.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/hand/finger_reach.h"
#include "tests/physics/session_run.h"

namespace regrasp {
namespace {

using Kind = Verdict::Kind;

TEST(Session, LosingTheObjectFailsTheExploration) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  ASSERT_EQ(run.Explore(1).kind, Kind::kAllowed);
  run.Ticks(1000);
  run.Set("object.friction", 0.02);
  const std::int64_t job = run.last_job - 1;
  for (int k = 0; k < 10000 && run.session.job_running(); ++k) run.Tick();
  EXPECT_EQ(run.session.state(), SessionState::kDropped);
  bool found = false;
  for (const JobRecord& record : run.jobs) {
    if (record.id != job) continue;
    found = true;
    EXPECT_EQ(record.state, JobState::kFailed);
    EXPECT_EQ(record.explore.reason, ExploreReason::kDropped);
    EXPECT_STRNE(record.error, "");
  }
  EXPECT_TRUE(found);
}

TEST(Session, EachFingerExploresUphillWithoutDrop) {
  const int fingers = ShadowConfig().model.hand.num_fingers();
  for (int finger = 0; finger < fingers; ++finger) {
    SessionRun run(2);
    ASSERT_TRUE(run.Grasp());
    ASSERT_EQ(run.Explore(finger, 2).kind, Kind::kAllowed);
    EXPECT_EQ(run.session.state(), SessionState::kExploring);
    ASSERT_TRUE(run.FinishJob(30));
    const JobRecord job = run.Job();
    EXPECT_EQ(job.state, JobState::kDone) << job.error;
    EXPECT_EQ(job.explore.finger, finger);
    EXPECT_EQ(job.explore.seed, 2u);
    EXPECT_GT(job.explore.cycles, 0);
    EXPECT_GT(job.explore.path_length_m, 1e-3);
    EXPECT_EQ(job.progress, 1);
    EXPECT_TRUE(job.explore.reason == ExploreReason::kGradient ||
                job.explore.reason == ExploreReason::kMaxCycles);
    EXPECT_EQ(job.explore.converged, job.explore.reason == ExploreReason::kGradient);
    EXPECT_GT(job.explore.phi_true_final, job.explore.phi_true_initial)
        << run.session.config().model.hand.fingers[static_cast<std::size_t>(finger)].name;
    EXPECT_EQ(run.session.state(), SessionState::kHolding);
    EXPECT_EQ(run.Count(EventKind::kDropped), 0);
    EXPECT_LT(Wander(&run, 0.5), 2e-3);
    std::printf(
        "explore %s: phi %.4f -> %.4f, %d cycles, %s\n",
        run.session.config().model.hand.fingers[static_cast<std::size_t>(finger)].name.c_str(),
        job.explore.phi_true_initial, job.explore.phi_true_final, job.explore.cycles,
        Name(job.explore.reason).data());
  }
}

// A search that keeps its start gradient and takes it for converged goes where the seed points.
TEST(Session, ASearchThatConvergesLowerThanItBeganHasFallen) {
  int fallen = 0, risen = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SessionRun run(2);
    ASSERT_TRUE(run.Grasp());
    run.Set("exploration.lambda", 0.999);
    run.Set("exploration.sigma", 1);
    run.Set("exploration.epsilon", 1000);
    run.Set("exploration.converged_updates", 10);
    run.Set("exploration.worth_returning", 2);
    run.Set("exploration.tries", 1);
    run.Set("exploration.no_gain_s", 0);
    ASSERT_EQ(run.Explore(2, seed).kind, Kind::kAllowed);
    ASSERT_TRUE(run.FinishJob(30));
    const ExploreResult& result = run.Job().explore;
    const bool lower = result.phi_final < 0.98 * result.phi_initial;
    EXPECT_EQ(result.reason, lower ? ExploreReason::kFell : ExploreReason::kGradient) << seed;
    EXPECT_EQ(result.converged, !lower) << seed;
    EXPECT_EQ(run.Job().state, JobState::kDone);
    (lower ? fallen : risen) += 1;
  }
  EXPECT_GT(fallen, 0);
  EXPECT_GT(risen, 0);
}

// The others shift their contacts until the thumb may leave (the paper's S_F), or say why it may
// not.
TEST(Session, MakesRoomForAnExplorerThatMayNotLeaveYet) {
  constexpr int kThumb = 4;
  struct Case {
    double margin_min;  // [N]; without shifting there is about 0.1 N without the thumb
    JobState end;
  };
  for (const Case& c : {Case{0.4, JobState::kDone}, Case{8.0, JobState::kFailed}}) {
    SessionConfig config = ShadowConfig(3);
    config.parameters.control.follow_object = 0;  // a poor grasp
    config.parameters.gait.margin_min = c.margin_min;
    config.parameters.gait.margin_wanted = 2 * c.margin_min;
    SessionRun run(std::move(config));
    ASSERT_TRUE(run.Grasp());
    ASSERT_LT(run.Snapshot().fingers[kThumb].load_margin_without, c.margin_min);
    ASSERT_EQ(run.Explore(kThumb, 0, 500).kind, Kind::kAllowed);
    ASSERT_TRUE(run.FinishJob(60));
    const JobRecord job = run.Job();
    EXPECT_EQ(job.state, c.end) << job.error;
    EXPECT_EQ(run.session.state(), SessionState::kHolding);
    EXPECT_EQ(job.explore.cycles > 0, c.end == JobState::kDone);
    EXPECT_EQ(std::string(job.error).find("thumb may not leave: the load margin") == 0,
              c.end == JobState::kFailed)
        << job.error;
  }
}

// Each finger, either sense of the turn; judged by the true joint angles, not by what it maximised.
TEST(Session, ExploringByReserveLeavesMoreWayForTheTurn) {
  const HandModel& hand = ShadowConfig().model.hand;
  double before_sum = 0, after_sum = 0;
  int done = 0, more = 0;
  for (int finger = 0; finger < hand.num_fingers(); ++finger) {
    for (const double sense : {-1.0, 1.0}) {
      SessionRun run(3);
      ASSERT_TRUE(run.Grasp());
      const Vector3d axis = sense * Vector3d::UnitZ();
      run.Set("exploration.turn_axis", axis);
      const auto reserve = [&] {
        const WorldState& truth = run.session.truth();
        const FingerPosture now = PostureAt(hand, finger, AnglesOf(hand, finger, truth.q));
        return MotionReserve(hand, finger, now, truth.p_WO, axis, 0.04, kMostReserve, {});
      };
      const double before = reserve();
      ASSERT_EQ(run.Give(CommandType::kExplore,
                         [&](Command* c) {
                           c->finger = finger;
                           c->criterion = Criterion::kReserve;
                           c->seed = 3;
                         })
                    .kind,
                Kind::kAllowed);
      ASSERT_TRUE(run.FinishJob(30));
      const JobRecord job = run.Job();
      done += job.state == JobState::kDone;
      EXPECT_EQ(job.explore.criterion, Criterion::kReserve);
      const double after = reserve();
      std::printf("reserve of %s, %+.0f z: %.3f -> %.3f rad; phi %.3f -> %.3f\n",
                  hand.fingers[static_cast<std::size_t>(finger)].name.c_str(), sense, before, after,
                  job.explore.phi_true_initial, job.explore.phi_true_final);
      more += after > before;
      before_sum += before;
      after_sum += after;
    }
  }
  EXPECT_GE(done, 9);  // of 10: the little finger may slide off the end of its tip
  EXPECT_GE(more, 7);
  EXPECT_GT(after_sum / before_sum, 1.2);
}

TEST(Session, AReserveNeedsTheAxisOfATurn) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  run.Set("exploration.turn_axis", Vector3d(Vector3d::Zero()));
  const auto explore = [&](Criterion criterion) {
    return run.Give(CommandType::kExplore, [&](Command* c) {
      c->finger = 1;
      c->criterion = criterion;
    });
  };
  const Verdict verdict = explore(Criterion::kReserve);
  EXPECT_EQ(verdict.kind, Kind::kBadState);
  EXPECT_NE(std::string(verdict.reason).find("exploration.turn_axis"), std::string::npos);
  EXPECT_EQ(explore(Criterion::kManipulability).kind, Kind::kAllowed);
}

TEST(Session, ProgressOfAnExplorationIsAgainstWhatWasAskedFor) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  ASSERT_EQ(run.Explore(3, 1, 800).kind, Kind::kAllowed);
  double progress = 0;
  int cycle = 0;
  while (run.session.job_running()) {
    run.Tick();
    const Frame frame = run.Snapshot();
    if (!run.session.job_running()) break;
    EXPECT_GE(frame.job.progress, progress);  // never back
    progress = frame.job.progress;
    cycle = std::max(cycle, frame.exploration.cycle);
  }
  // It is brought up to date every 10 cycles and stops at 0.99 until the job is done.
  EXPECT_NEAR(progress, std::min(0.99, cycle / 800.0), 10.0 / 800);
}

TEST(Session, StopDuringAnExplorationLeadsToHolding) {
  SessionRun whole;
  ASSERT_TRUE(whole.Grasp());
  const std::int64_t start = whole.session.tick();
  ASSERT_EQ(whole.Explore(0, 1, 1500).kind, Kind::kAllowed);
  ASSERT_TRUE(whole.FinishJob());
  const int duration = static_cast<int>(whole.session.tick() - start);
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  for (int step = 0; step < 8; ++step) {
    ASSERT_EQ(run.Explore(step % 5, 1, 1500).kind, Kind::kAllowed);
    const std::int64_t job = run.last_job;
    run.Ticks(1 + step * (duration - 20) / 7);
    if (!run.session.job_running()) continue;  // another finger, another duration
    ASSERT_EQ(run.Give(CommandType::kStop).kind, Kind::kAllowed);
    ASSERT_TRUE(run.FinishJob(5)) << step;
    EXPECT_EQ(run.jobs.back().id, job);
    EXPECT_EQ(run.jobs.back().state, JobState::kCancelled) << step;
    EXPECT_EQ(run.jobs.back().explore.reason, ExploreReason::kCancelled);
    EXPECT_EQ(run.session.state(), SessionState::kHolding) << step;
    run.Ticks(200);
    EXPECT_EQ(run.session.state(), SessionState::kHolding) << step;
  }
  EXPECT_EQ(run.Count(EventKind::kDropped), 0);
}

}  // namespace
}  // namespace regrasp
