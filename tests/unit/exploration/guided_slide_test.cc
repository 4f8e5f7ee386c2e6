// The phases of the guided slide, and what ends it.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/unit/exploration/slide_fixture.h"

namespace regrasp {
namespace {

TEST_F(SlideTest, UnloadsFromTheForceItHasWithoutAStep) {
  estimate_.fingers[0].force = 1.7;
  Start();
  Tick();
  double before = tasks_[0].cap;
  EXPECT_NEAR(before, 1.7, 1.7 * kDt / profile_.transfer_s);
  const double step = 1.7 / profile_.transfer_s * kDt;
  while (slide_.phase() == Phase::kUnload) {
    Tick();
    EXPECT_LE(tasks_[0].cap, before);
    EXPECT_LE(before - tasks_[0].cap, step);
    before = tasks_[0].cap;
  }
  EXPECT_EQ(slide_.phase(), Phase::kSettle);
  EXPECT_DOUBLE_EQ(before, parameters_.normal_force);
  EXPECT_EQ(ticks_, static_cast<int>(std::lround(profile_.transfer_s / kDt)));
}

TEST_F(SlideTest, PressesLessWhereTheOthersCanCarryLess) {
  for (const double margin : {0.0, 0.6, 5.0}) {
    margins_.without[0] = margin;
    Start();
    ASSERT_TRUE(RunTo(Phase::kSettle));
    Tick();
    EXPECT_DOUBLE_EQ(tasks_[0].force, std::clamp(parameters_.force_share * margin,
                                                 parameters_.least_force * parameters_.normal_force,
                                                 parameters_.normal_force));
  }
}

TEST_F(SlideTest, FindsTheMaximumAndTakesUpItsLoad) {
  const double first = FromTop();
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  EXPECT_TRUE(slide_.slide_began());
  while (!slide_.slide_ended()) Tick();
  EXPECT_LT(FromTop(), 0.5 * first);
  EXPECT_GT(slide_.phi_final(), slide_.phi_initial());
  EXPECT_TRUE(slide_.end() == End::kGradient || slide_.end() == End::kNoGain);
  ASSERT_TRUE(RunTo(Phase::kDone));
  EXPECT_EQ(tasks_[0].mode, FingerMode::kHold);
  EXPECT_EQ(tasks_[0].cap, control_.max_normal_force);
  EXPECT_FALSE(slide_.no_surface());
}

// With epsilon 0 no gradient counts as converged.
TEST_F(SlideTest, EndsWhereNothingIsGainedAnyMore) {
  parameters_.epsilon = 0;
  parameters_.no_gain_s = 0.5;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  double best = slide_.phi(), gained_s = 0;
  while (slide_.phase() == Phase::kExplore) {
    Tick();
    if (slide_.phi() < parameters_.worth_returning * best) continue;
    best = slide_.phi();
    gained_s = slide_.cycles() * kDt;
  }
  EXPECT_GT(slide_.cycles() * kDt, gained_s + 0.9 * parameters_.no_gain_s);
  EXPECT_LT(slide_.cycles() * kDt, gained_s + 2 * parameters_.no_gain_s);
  while (!slide_.slide_ended()) Tick();
  EXPECT_EQ(slide_.end(), End::kNoGain);
  EXPECT_LT(FromTop(), 1e-3);

  parameters_.no_gain_s = 0;
  Place(StartAt(4e-3));
  Start();
  while (!slide_.slide_ended()) Tick();
  EXPECT_EQ(slide_.end(), End::kMaxCycles);
}

TEST_F(SlideTest, EndsAfterItsTime) {
  profile_.explore_s = 0.2;
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  const int begin = ticks_;
  while (!slide_.slide_ended()) Tick();
  EXPECT_EQ(slide_.end(), End::kTime);
  // The way back to the best contact comes on top.
  EXPECT_LE((ticks_ - begin) * kDt, profile_.explore_s + profile_.return_limit_s + 3 * kDt);
}

TEST_F(SlideTest, LosesItsContactOnceWhateverThePhase) {
  for (const Phase phase : {Phase::kRecall, Phase::kExplore}) {
    guide_.recall_W =
        phase == Phase::kRecall ? std::optional<Vector3d>(StartAt(8e-3)) : std::nullopt;
    Place(StartAt(4e-3));
    Contact(true);
    Start();
    ASSERT_TRUE(RunTo(phase));
    const int begin = ticks_;
    while (!slide_.slide_ended() && ticks_ < begin + 2000) {
      Contact(false);
      Tick();
    }
    EXPECT_EQ(slide_.end(), End::kContactLost);
    EXPECT_NEAR((ticks_ - begin) * kDt, parameters_.lost_contact_s, 1.5 * kDt);
    // Without a surface the load is not taken up for ever.
    ASSERT_TRUE(RunTo(Phase::kDone));
    EXPECT_TRUE(slide_.no_surface());
  }
}

TEST_F(SlideTest, AShortLossIsNone) {
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  for (int k = 0; k < static_cast<int>(parameters_.lost_contact_s / kDt) - 1; ++k) {
    Contact(false);
    Tick();
  }
  Contact(true);
  Tick();
  EXPECT_EQ(slide_.phase(), Phase::kExplore);
}

TEST_F(SlideTest, WaitsForTheObjectThenGivesUp) {
  Start();
  ASSERT_TRUE(RunTo(Phase::kExplore));
  estimate_.p_WO.x() += 1.01 * parameters_.object_stop;
  const int begin = ticks_;
  while (!slide_.slide_ended() && ticks_ < begin + 2000) {
    Tick();
    if (slide_.slide_ended()) break;
    EXPECT_EQ(tasks_[0].v_W.norm(), 0);
  }
  EXPECT_EQ(slide_.end(), End::kObjectMoved);
  EXPECT_NEAR((ticks_ - begin) * kDt, parameters_.object_wait_s, 1.5 * kDt);
}

TEST_F(SlideTest, StopsInEveryPhase) {
  for (const Phase phase :
       {Phase::kUnload, Phase::kSettle, Phase::kRecall, Phase::kExplore, Phase::kReload}) {
    Place(StartAt(4e-3));
    guide_.recall_W = StartAt(6e-3);
    Start();
    ASSERT_TRUE(RunTo(phase));
    slide_.Stop();
    const int begin = ticks_;
    ASSERT_TRUE(RunTo(Phase::kDone));
    // At once into the load transfer.
    EXPECT_LE((ticks_ - begin) * kDt, profile_.transfer_s + 2 * kDt);
    EXPECT_EQ(tasks_[0].mode, FingerMode::kHold);
    EXPECT_EQ(tasks_[0].cap, control_.max_normal_force);
  }
}

TEST_F(SlideTest, AFingerThatGoesAwayIsLeftToItsMover) {
  profile_.leave_force = 0.05;
  Start(true);
  ASSERT_TRUE(RunTo(Phase::kAway));
  EXPECT_NEAR(tasks_[0].cap, profile_.leave_force, 1e-12);
  tasks_[0].mode = FingerMode::kReach;
  for (int k = 0; k < 100; ++k) Tick();
  EXPECT_EQ(slide_.phase(), Phase::kAway);
  EXPECT_EQ(tasks_[0].mode, FingerMode::kReach);
  slide_.Land(true);
  EXPECT_EQ(slide_.phase(), Phase::kSettle);
  Start(true);
  ASSERT_TRUE(RunTo(Phase::kAway));
  slide_.Stop();
  slide_.Land(true);  // wanted to explore, but is stopped
  EXPECT_EQ(slide_.phase(), Phase::kReload);
}

}  // namespace
}  // namespace regrasp
