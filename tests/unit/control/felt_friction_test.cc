#include "core/control/felt_friction.h"

#include <gtest/gtest.h>

namespace regrasp {
namespace {

constexpr double kDt = 0.001;

/// One finger that touches the top of an object, its task and the force asked of it.
struct Scene {
  Estimate estimate;
  FingerTasks tasks;
  FixedVector<Vector3d, kMaxFingers> commanded;

  Scene(double speed, double tangential) {
    FingerEstimate finger;
    finger.in_contact = true;
    finger.normal_W = Vector3d::UnitZ();
    finger.force = 0.3;
    estimate.fingers.push_back(finger);
    FingerTask task;
    task.mode = FingerMode::kSlide;
    task.v_W = Vector3d(speed, 0, 0);
    tasks.push_back(task);
    commanded.push_back(Vector3d(tangential, 0, -0.3));
  }
  void Run(double seconds, FeltFriction* friction) const {
    for (int k = 0; k < static_cast<int>(seconds / kDt); ++k)
      friction->Update(estimate, tasks, commanded, ControlParameters(), kDt);
  }
};

TEST(FeltFriction, IsTheTangentialForceOfASlidingFingerPerNormalForce) {
  FeltFriction friction;
  Scene(0.01, 0.18).Run(0.3, &friction);
  ASSERT_TRUE(friction.known(ControlParameters()));
  EXPECT_NEAR(friction.felt(), 0.6, 1e-9);
  EXPECT_NEAR(friction.Counted(0.85, ControlParameters()), 0.51, 1e-9);
}

TEST(FeltFriction, CountsOnWhatItWasToldUntilFingersHaveSlidForLongEnough) {
  FeltFriction friction;
  Scene(0.01, 0.18).Run(0.1, &friction);
  EXPECT_FALSE(friction.known(ControlParameters()));
  EXPECT_EQ(friction.Counted(0.85, ControlParameters()), ControlParameters().friction_estimate);
}

TEST(FeltFriction, AFingerThatRestsOrHardlyTouchesTellsNothing) {
  FeltFriction friction;
  Scene(0.0, 0.18).Run(1.0, &friction);
  Scene light(0.01, 0.18);
  light.estimate.fingers[0].force = 0.05;
  light.Run(1.0, &friction);
  Scene holds(0.01, 0.18);
  holds.tasks[0].mode = FingerMode::kHold;
  holds.Run(1.0, &friction);
  EXPECT_EQ(friction.felt_s(), 0);
}

TEST(FeltFriction, FollowsWhatIsFeltLater) {
  FeltFriction friction;
  Scene(0.01, 0.24).Run(2.0, &friction);
  Scene(0.01, 0.12).Run(10.0, &friction);
  EXPECT_NEAR(friction.felt(), 0.4, 0.01);
}

}  // namespace
}  // namespace regrasp
