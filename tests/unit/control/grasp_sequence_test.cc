#include "core/control/grasp_sequence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/common/random.h"
#include "core/exploration/exploration_parameters.h"
#include "core/gait/gait_parameters.h"
#include "core/shape/felt_surface.h"
#include "tests/unit/control/held_sphere.h"

namespace regrasp {
namespace {

constexpr double kDt = 1e-3;
using Phase = GraspSequence::Phase;

class GraspSequenceTest : public ::testing::Test {
 protected:
  /// Runs with the first `touching` fingers in contact from the start; true when it ended.
  bool Run(int touching, int max_ticks) {
    SensorReading reading = TouchingReading(hand_, scenario_.scenario.q_preshape, 0.2);
    for (int i = touching; i < hand_.num_fingers(); ++i)
      reading.fingertips[static_cast<std::size_t>(i)].in_contact = false;
    StateEstimator estimator(hand_, kDt);
    Start(estimator.Update(reading, parameters_));
    double progress = 0;
    Vector3d p_WO = reading.p_WO;
    for (ticks_ = 0; ticks_ < max_ticks; ++ticks_) {
      if (!sequence_.needs_stand_in()) p_WO += drift_ * kDt;
      if (ticks_ % 66 == 0) reading.p_WO = p_WO + pose_noise_ * random_.Normal3();  // at 15 Hz
      if (pose_noise_ == 0) reading.p_WO = p_WO;
      const Estimate& e = estimator.Update(reading, parameters_);
      sequence_.Update(TickOf(e), &controller_, &tasks_);
      EXPECT_GE(sequence_.progress(), progress);  // never goes back
      progress = sequence_.progress();
      held_alone_ += !sequence_.needs_stand_in();
      EXPECT_TRUE(controller_.Update(e, tasks_, {}, gravity_, parameters_).allFinite());
      if (sequence_.phase() >= Phase::kDone) return true;
    }
    return false;
  }

  void Start(const Estimate& e) {
    sequence_.Start(TickOf(e), scenario_.scenario.q_closed, scenario_.scenario.X_WO.translation());
  }

  ControlTick TickOf(const Estimate& e) const {
    return {hand_, e, {}, margins_, felt_, gravity_, parameters_, exploration_, gait_, kDt};
  }

  const LoadedScenario scenario_ = ShadowHand();
  const HandModel& hand_ = scenario_.hand;
  const Vector3d gravity_ = GraspGravity();
  ControlParameters parameters_;
  const ExplorationParameters exploration_;
  const GaitParameters gait_;
  const LoadMargins margins_;
  const FeltSurface felt_;
  GraspSequence sequence_;
  HybridController controller_{hand_, kDt};
  FingerTasks tasks_;
  int ticks_ = 0, held_alone_ = 0;
  Vector3d drift_ = Vector3d::Zero();  // of the object, once it is left alone [m/s]
  double pose_noise_ = 0;              // sigma of the sensed position, per axis [m]
  RandomStream random_{1, 0};
};

TEST_F(GraspSequenceTest, LetsGoOfTheObjectLongBeforeItIsDone) {
  ASSERT_TRUE(Run(5, 20000));
  EXPECT_EQ(sequence_.phase(), Phase::kDone);
  EXPECT_FALSE(sequence_.needs_stand_in());
  EXPECT_NEAR(held_alone_ * kDt, parameters_.settle_s, 3 * kDt);  // a tick per change of phase
  EXPECT_EQ(sequence_.progress(), 1.0);
  for (const FingerTask& task : tasks_) {
    EXPECT_EQ(task.mode, FingerMode::kHold);
    EXPECT_NEAR(task.grip, parameters_.grip_force, 1e-12);
    EXPECT_NEAR(task.cap, parameters_.max_normal_force, 1e-12);
  }
}

TEST_F(GraspSequenceTest, ThreeFingersAreEnoughTwoAreNot) {
  ASSERT_TRUE(Run(3, 20000));
  EXPECT_EQ(sequence_.phase(), Phase::kDone);
  EXPECT_EQ(tasks_[4].mode, FingerMode::kReach);  // never touched: takes no part
  sequence_ = GraspSequence();
  held_alone_ = 0;
  ASSERT_TRUE(Run(2, 20000));
  EXPECT_EQ(sequence_.phase(), Phase::kFailed);
  EXPECT_TRUE(sequence_.needs_stand_in());
  EXPECT_EQ(held_alone_, 0);  // the object was never left alone
}

TEST_F(GraspSequenceTest, TheClosedPostureFollowsTheObjectToWhereItIsSensed) {
  const Vector3d moved(0.004, -0.003, 0.005);
  SensorReading reading = TouchingReading(hand_, scenario_.scenario.q_preshape, 0);
  for (FingertipReading& r : reading.fingertips) r.in_contact = false;
  reading.p_WO = scenario_.scenario.X_WO.translation() + moved;
  StateEstimator estimator(hand_, kDt);
  const Estimate& e = estimator.Update(reading, UnfilteredParameters());
  KinematicsData closed, followed;
  ForwardKinematics(hand_, scenario_.scenario.q_closed, &closed);
  for (const double share : {0.0, 0.5, 1.0}) {
    parameters_.follow_object = share;
    Start(e);
    JointVector target = reading.q;
    for (int tick = 0; tick < 8000; ++tick) {
      sequence_.Update(TickOf(e), &controller_, &tasks_);
      if (tasks_[0].mode != FingerMode::kPosture) break;
      for (int i = 0; i < hand_.num_fingers(); ++i)
        for (std::size_t k = 0; k < hand_.fingers[i].joints.size(); ++k)
          target[hand_.fingers[i].joints[k]] = tasks_[i].q_target[static_cast<Eigen::Index>(k)];
    }
    ForwardKinematics(hand_, target, &followed);
    for (int i = 0; i < hand_.num_fingers(); ++i) {
      const Vector3d way = FingertipCentre(hand_, followed, i) - FingertipCentre(hand_, closed, i);
      EXPECT_NEAR((way - share * moved).norm(), 0, 3e-4) << hand_.fingers[i].name << share;
    }
  }
}

TEST_F(GraspSequenceTest, AnObjectThatMovesOnIsNotHeld) {
  // Just slower and just faster than what counts as rest.
  for (const double speed : {0.9, 1.1}) {
    sequence_ = GraspSequence();
    drift_ = speed * parameters_.rest_speed * Vector3d::UnitZ();
    held_alone_ = 0;
    ASSERT_TRUE(Run(5, 20000));
    EXPECT_EQ(sequence_.phase(), speed < 1 ? Phase::kDone : Phase::kRestless);
    EXPECT_FALSE(sequence_.needs_stand_in());
    EXPECT_NEAR(sequence_.drift_speed(), drift_.norm(), 0.03 * drift_.norm());
    EXPECT_NEAR(held_alone_ * kDt, parameters_.settle_s + (speed < 1 ? 0 : parameters_.rest_s),
                3 * kDt);
  }
}

TEST_F(GraspSequenceTest, TheNoiseOfTheSensedPoseIsNoMotion) {
  parameters_.settle_s = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    sequence_ = GraspSequence();
    random_ = RandomStream(seed, 0);
    pose_noise_ = 0.005;  // as with taxels
    ASSERT_TRUE(Run(5, 20000));
    EXPECT_EQ(sequence_.phase(), Phase::kDone) << seed << ' ' << sequence_.drift_speed();
  }
}

TEST_F(GraspSequenceTest, ClosesNoFasterThanItsSpeed) {
  SensorReading reading = TouchingReading(hand_, scenario_.scenario.q_preshape, 0);
  for (FingertipReading& r : reading.fingertips) r.in_contact = false;
  StateEstimator estimator(hand_, kDt);
  const Estimate& e = estimator.Update(reading, parameters_);
  Start(e);
  FingerTasks before;
  for (int tick = 0; tick < 8000 && sequence_.phase() != Phase::kFailed; ++tick) {
    sequence_.Update(TickOf(e), &controller_, &tasks_);
    if (tick > 0 && sequence_.phase() == Phase::kClose) {
      for (std::size_t i = 0; i < tasks_.size(); ++i)
        ASSERT_LE((tasks_[i].q_target - before[i].q_target).cwiseAbs().maxCoeff(),
                  parameters_.close_speed * kDt * (1 + 1e-9));
    }
    before = tasks_;
  }
  EXPECT_EQ(sequence_.phase(), Phase::kFailed);
}

}  // namespace
}  // namespace regrasp
