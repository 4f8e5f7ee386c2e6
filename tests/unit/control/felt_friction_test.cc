#include "core/control/felt_friction.h"

#include <gtest/gtest.h>

#include "tests/unit/control/held_sphere.h"

namespace regrasp {
namespace {

constexpr double kDt = 0.001;
const Vector3d kGravity(0.5, 9, -3);

/// A hand whose ring finger slides with `speed` [m/s] over an object, its torques those of a tip
/// that is pushed along with `tangential` [N] and pressed on with 0.3 N, and of its joints'
/// damping.
struct Scene {
  LoadedScenario scenario = ShadowHand();
  const HandModel& hand = scenario.hand;
  int finger = hand.FindFinger("ring");
  Estimate estimate = TouchingEstimate(hand, GraspPosture(hand));
  FingerTasks tasks;
  JointVector torque = JointVector::Zero(hand.num_joints());
  JointVector rate = JointVector::Zero(hand.num_joints());

  Scene(double speed, double tangential) {
    tasks.resize(estimate.fingers.size());
    FingerEstimate& f = estimate.fingers[static_cast<std::size_t>(finger)];
    f.force = 0.3;
    const Vector3d along = RotationFromZ(f.normal_W).col(0);
    FingerTask& task = tasks[static_cast<std::size_t>(finger)];
    task.mode = FingerMode::kSlide;
    task.v_W = speed * along;
    const Eigen::VectorXd qdot = f.J.completeOrthogonalDecomposition().solve(task.v_W);
    const auto& joints = hand.fingers[static_cast<std::size_t>(finger)].joints;
    for (std::size_t k = 0; k < joints.size(); ++k)
      rate[joints[k]] = qdot[static_cast<Eigen::Index>(k)];
    Push(tangential);
  }
  void Push(double tangential) {
    FingerEstimate& f = slider();
    const Vector3d along = RotationFromZ(f.normal_W).col(0);
    const Eigen::VectorXd push = f.J.transpose() * (tangential * along - 0.3 * f.normal_W);
    const auto& joints = hand.fingers[static_cast<std::size_t>(finger)].joints;
    torque = GravityTorque(hand, estimate.kinematics, kGravity);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const auto j = static_cast<std::size_t>(joints[k]);
      torque[joints[k]] +=
          push[static_cast<Eigen::Index>(k)] + hand.joints[j].damping * rate[joints[k]];
    }
  }
  FingerEstimate& slider() { return estimate.fingers[static_cast<std::size_t>(finger)]; }
  /// The posture stays, as if each tick began again: only the rates matter.
  void Run(double seconds, FeltFriction* friction) {
    for (int k = 0; k < static_cast<int>(seconds / kDt); ++k) {
      estimate.q += rate * kDt;
      friction->Update(hand, estimate, tasks, torque, kGravity, ControlParameters(), kDt);
    }
  }
};

// The tip's Jacobian is inverted with a damping of 1 mm: less than 1 % of the force.
TEST(FeltFriction, IsTheForceAlongTheSlidePerNormalForceWhateverTheJointsDamp) {
  FeltFriction friction;
  Scene(0.01, 0.18).Run(0.3, &friction);
  ASSERT_TRUE(friction.known(ControlParameters()));
  EXPECT_NEAR(friction.felt(), 0.6, 0.01);
  EXPECT_NEAR(friction.Counted(0.85, ControlParameters()), 0.51, 0.01);
  FeltFriction fast;
  Scene(0.03, 0.18).Run(0.3, &fast);
  EXPECT_NEAR(fast.felt(), friction.felt(), 1e-6);
}

TEST(FeltFriction, CountsOnWhatItWasToldUntilFingersHaveSlidForLongEnough) {
  FeltFriction friction;
  Scene(0.01, 0.18).Run(0.1, &friction);
  EXPECT_FALSE(friction.known(ControlParameters()));
  EXPECT_EQ(friction.Counted(0.85, ControlParameters()), ControlParameters().friction_estimate);
}

// A few tips on a few spots feel too much at times, and what is counted on brings the fingers so
// much nearer to slipping.
TEST(FeltFriction, CountsOnNoMoreThanTheMostHoweverRoughItFeels) {
  FeltFriction friction;
  Scene(0.01, 0.36).Run(0.3, &friction);
  ASSERT_NEAR(friction.felt(), 1.2, 0.02);
  ControlParameters parameters;
  EXPECT_EQ(friction.Counted(0.85, parameters), parameters.feel_most);
  parameters.feel_most = 1;
  EXPECT_EQ(friction.Counted(0.85, parameters), 1);
  EXPECT_NEAR(friction.Counted(0.5, parameters), 0.6, 0.01);
  // The least wins where they contradict each other.
  parameters.feel_least = 0.8;
  parameters.feel_most = 0.4;
  EXPECT_EQ(friction.Counted(0.85, parameters), 0.8);
}

// As of a finger that another one holds back: no friction is negative.
TEST(FeltFriction, AMeanThatCannotBeIsNotBelievedUntilMoreIsFelt) {
  FeltFriction friction;
  Scene scene(0.01, -0.12);
  scene.Run(0.3, &friction);
  ASSERT_LT(friction.felt(), 0);
  EXPECT_FALSE(friction.known(ControlParameters()));
  EXPECT_EQ(friction.Counted(0.85, ControlParameters()), ControlParameters().friction_estimate);
  scene.Push(0.18);
  scene.Run(1.0, &friction);
  EXPECT_TRUE(friction.known(ControlParameters()));
  EXPECT_NEAR(friction.felt(), 0.6 - 0.2 * 1.0 / 1.2, 0.02);
}

TEST(FeltFriction, AFingerThatRestsOrHardlyTouchesTellsNothing) {
  FeltFriction friction;
  Scene(0.0, 0.18).Run(1.0, &friction);
  Scene light(0.01, 0.18);
  light.slider().force = 0.05;
  light.Run(1.0, &friction);
  Scene holds(0.01, 0.18);
  holds.tasks[static_cast<std::size_t>(holds.finger)].mode = FingerMode::kHold;
  holds.Run(1.0, &friction);
  EXPECT_EQ(friction.felt_s(), 0);
}

TEST(FeltFriction, FollowsWhatIsFeltLater) {
  FeltFriction friction;
  Scene scene(0.01, 0.24);
  scene.Run(2.0, &friction);
  scene.Push(0.12);
  scene.Run(10.0, &friction);
  EXPECT_NEAR(friction.felt(), 0.4, 0.01);
}

}  // namespace
}  // namespace regrasp
