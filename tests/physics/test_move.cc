// Local manipulation in closed loop, on the session: what `move` promises, each on one seed. How
// far the hand reaches over seeds is measured by `claims move` (bench/claims), not here.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/malloc_counter.h"
#include "tests/physics/session_run.h"

namespace regrasp {
namespace {

constexpr double kDegree = M_PI / 180.0;
// README's bounds for one motion.
constexpr double kAngleError = 5 * kDegree, kPositionError = 0.004;

Verdict Move(SessionRun* run, const Vector3d& offset, const Vector3d& rotation) {
  return run->Give(CommandType::kMove, [&](Command* c) {
    c->offset_W = offset;
    c->rotation_W = rotation;
  });
}

double AngleError(const MoveResult& r) {
  return RotationVector(FromRotationVector(r.achieved_rotation_rad) *
                        FromRotationVector(r.rotation_rad).conjugate())
      .norm();
}

TEST(Move, TurnsAndShiftsAndDoesBothAtOnce) {
  const struct {
    Vector3d offset, rotation;
  } kCases[] = {{Vector3d::Zero(), {0, 0, 15 * kDegree}},
                {{0.005, 0, 0}, Vector3d::Zero()},
                {{0, -0.004, 0.003}, {-10 * kDegree, 0, 0}}};
  for (const auto& c : kCases) {
    SessionRun run;
    ASSERT_TRUE(run.Grasp());
    const WorldState before = run.session.truth();
    ASSERT_EQ(Move(&run, c.offset, c.rotation).kind, Verdict::Kind::kAllowed);
    EXPECT_EQ(run.session.state(), SessionState::kMoving);
    ASSERT_TRUE(run.FinishJob());
    const JobRecord job = run.Job();
    EXPECT_EQ(job.state, JobState::kDone) << job.error;
    EXPECT_TRUE(job.move.reached) << Name(job.move.end);
    EXPECT_EQ(job.move.end, MoveEnd::kReached);
    EXPECT_EQ(job.move.end_finger, -1);
    EXPECT_LT(AngleError(job.move), kAngleError);
    EXPECT_LT((job.move.achieved_offset_m - c.offset).norm(), kPositionError);
    EXPECT_LT(job.move.max_position_error_m, kPositionError);
    EXPECT_LT(job.move.max_rotation_error_rad, kAngleError);
    // The record says what happened; one tick passes between its last look and this one.
    const Vector3d moved = run.session.truth().p_WO - before.p_WO;
    EXPECT_LT((moved - job.move.achieved_offset_m).norm(), 1e-4);
    // At full speed the way takes this long; ramps and rest add less than a second.
    const GaitParameters& gait = run.session.parameters().gait;
    const double duration =
        std::max(c.offset.norm() / gait.move_speed, c.rotation.norm() / gait.speed_rad_s);
    EXPECT_GT(job.move.sim_time_s, duration);
    EXPECT_LT(job.move.sim_time_s, duration + 1);
    run.Ticks(1000);
    EXPECT_EQ(run.session.state(), SessionState::kHolding);
    EXPECT_EQ(run.Count(EventKind::kDropped), 0);
  }
}

TEST(Move, EndsAtItsLimitWithItsNameAndGoesOnHolding) {
  for (const Vector3d& axis :
       {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(0, 1, 0), Vector3d(1, 0, 0)}) {
    SessionRun run;
    ASSERT_TRUE(run.Grasp());
    Move(&run, Vector3d::Zero(), 170 * kDegree * axis);
    ASSERT_TRUE(run.FinishJob());
    const JobRecord job = run.Job();
    EXPECT_EQ(job.state, JobState::kDone) << job.error;
    EXPECT_FALSE(job.move.reached);
    EXPECT_NE(job.move.end, MoveEnd::kReached);
    EXPECT_NE(job.move.end, MoveEnd::kNone);
    EXPECT_EQ(job.move.end_finger >= 0, job.move.end == MoveEnd::kJointLimit ||
                                            job.move.end == MoveEnd::kManipulability ||
                                            job.move.end == MoveEnd::kExcursion);
    run.Ticks(1000);
    EXPECT_EQ(run.session.state(), SessionState::kHolding);
    EXPECT_EQ(run.Count(EventKind::kDropped), 0);
    // And back: what ended the motion does not end the one away from it.
    Move(&run, Vector3d::Zero(), -5 * kDegree * axis);
    ASSERT_TRUE(run.FinishJob());
    EXPECT_TRUE(run.Job().move.reached) << Name(run.Job().move.end);
  }
}

// From these starts tips that only roll would end the turn after 8 to 13 degrees at a limit of
// abduction, whatever the controller did (`claims move --reach`).
TEST(Move, AFingerAtItsLimitSlidesBackWhileTheOthersHold) {
  for (const std::uint64_t seed : {105, 109, 113, 112}) {
    SessionRun run(seed);
    ASSERT_TRUE(run.Grasp());
    Move(&run, Vector3d::Zero(), {0, 30 * kDegree, 0});
    int slid = 0;
    for (int k = 0; k < 10000 && run.session.job_running(); ++k) {
      run.Tick();
      const Frame frame = run.Snapshot();
      const auto slides = std::ranges::count(frame.fingers, FingerRole::kMove, &FingerFrame::role);
      EXPECT_LE(slides, 1);
      slid += slides > 0;
    }
    const MoveResult r = run.Job().move;
    EXPECT_TRUE(r.reached) << seed << ": " << Name(r.end);
    EXPECT_LT(AngleError(r), kAngleError) << seed;
    EXPECT_LT(r.achieved_offset_m.norm(), kPositionError) << seed;
    EXPECT_LT(r.max_position_error_m, kPositionError) << seed;
    EXPECT_GT(slid, 0) << seed;
    run.Ticks(1000);
    EXPECT_EQ(run.session.state(), SessionState::kHolding) << seed;
  }
}

TEST(Move, AShiftIsJudgedByTheFirstPlaceOfTheContacts) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  Move(&run, {0, 0, 0.05}, Vector3d::Zero());
  ASSERT_TRUE(run.FinishJob());
  const MoveResult& r = run.Job().move;
  EXPECT_FALSE(r.reached);
  // Contacts go with the object; the fingers' excursion is bounded, and so is the object's.
  EXPECT_LT(r.achieved_offset_m.norm(), 1.5 * run.session.parameters().gait.max_excursion);
  EXPECT_EQ(run.session.state(), SessionState::kHolding);
}

TEST(Move, StopSlowsDownAndEndsInAHold) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  Move(&run, Vector3d::Zero(), {20 * kDegree, 0, 0});
  run.Ticks(400);
  ASSERT_EQ(run.session.state(), SessionState::kMoving);
  const std::int64_t job = run.last_job;
  ASSERT_EQ(run.Give(CommandType::kStop).kind, Verdict::Kind::kAllowed);
  EXPECT_TRUE(run.session.job_running());  // it slows down
  ASSERT_TRUE(run.FinishJob(2));
  EXPECT_EQ(run.jobs.back().id, job);
  EXPECT_EQ(run.jobs.back().state, JobState::kCancelled);
  EXPECT_EQ(run.jobs.back().move.end, MoveEnd::kStopped);
  EXPECT_FALSE(run.jobs.back().move.reached);
  const Vector3d p0 = run.session.truth().p_WO;
  run.Ticks(1000);
  EXPECT_EQ(run.session.state(), SessionState::kHolding);
  EXPECT_LT((run.session.truth().p_WO - p0).norm(), 2e-3);  // as in any hold
}

TEST(Move, LosingTheObjectFailsTheJob) {
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  run.Set("gait.move_speed", 0.0005);
  Move(&run, {0, 0.01, 0}, Vector3d::Zero());
  const std::int64_t job = run.last_job;
  run.Set("object.friction", 0.05);
  for (int k = 0; k < 10000 && run.session.job_running(); ++k) run.Tick();
  EXPECT_EQ(run.session.state(), SessionState::kDropped);
  EXPECT_EQ(run.jobs.back().id, job);
  EXPECT_EQ(run.jobs.back().state, JobState::kFailed);
  EXPECT_EQ(run.jobs.back().move.end, MoveEnd::kDropped);
  EXPECT_FALSE(run.jobs.back().move.reached);
}

TEST(Move, NeedsAHeldObjectAndNoOtherJob) {
  SessionRun run;
  EXPECT_EQ(Move(&run, {0, 0, 0.005}, Vector3d::Zero()).kind, Verdict::Kind::kBadState);
  ASSERT_TRUE(run.Grasp());
  ASSERT_EQ(Move(&run, {0, 0, 0.005}, Vector3d::Zero()).kind, Verdict::Kind::kAllowed);
  EXPECT_EQ(Move(&run, {0, 0, 0.005}, Vector3d::Zero()).kind, Verdict::Kind::kBusy);
  EXPECT_EQ(run.Job().method, JobMethod::kMove);
  EXPECT_EQ(run.Push({0.2, 0, 0}, 0.05).kind, Verdict::Kind::kAllowed);
  EXPECT_TRUE(run.FinishJob());
  EXPECT_EQ(run.session.state(), SessionState::kHolding);
}

TEST(Move, SameSeedSameBits) {
  std::uint64_t hash[2];
  for (std::uint64_t& h : hash) {
    SessionRun run(5);
    ASSERT_TRUE(run.Grasp());
    ASSERT_EQ(Move(&run, {0.002, 0, 0}, {0, 20 * kDegree, 0}).kind, Verdict::Kind::kAllowed);
    run.Ticks(3000);
    h = run.session.StateHash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(Move, TheHashSeesWhatIsWanted) {
  const auto after = [](const Vector3d& offset, const Vector3d& rotation) {
    SessionRun run;
    EXPECT_TRUE(run.Grasp());
    Move(&run, offset, rotation);
    return run.session.StateHash();
  };
  const std::uint64_t one = after({0.001, 0, 0}, Vector3d::Zero());
  EXPECT_EQ(one, after({0.001, 0, 0}, Vector3d::Zero()));
  EXPECT_NE(one, after({0.002, 0, 0}, Vector3d::Zero()));
  EXPECT_NE(one, after({0.001, 0, 0}, {0, 0, 0.1}));
}

TEST(Move, TicksAllocateNothing) {
  if (!CountsAllocations()) GTEST_SKIP() << "a sanitizer owns malloc";
  SessionRun run;
  ASSERT_TRUE(run.Grasp());
  ASSERT_EQ(Move(&run, {0, 0.003, 0}, {0, 25 * kDegree, 0}).kind, Verdict::Kind::kAllowed);
  const long before = AllocationCount();
  for (int k = 0; k < 10000 && run.session.job_running(); ++k) {
    run.session.Tick();
    run.session.TakeEvents();
    run.session.TakeFinishedJobs();
  }
  EXPECT_EQ(AllocationCount() - before, 0);
  EXPECT_FALSE(run.session.job_running());
}

}  // namespace
}  // namespace regrasp
