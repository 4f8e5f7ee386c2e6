// Bad input, forces beyond reason and faults; what a step may not do.

#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/common/random.h"
#include "tests/physics/malloc_counter.h"
#include "tests/physics/world_models.h"

namespace regrasp {
namespace {

TEST_P(EachStepper, SurvivesFullEffortNoise) {
  // The worst that a controller can ask for: full effort of random sign, new in every tick and then
  // held for 50 ticks, with the ball among the fingers and every joint thrown at its stops.
  for (const int hold : {1, 50}) {
    World world(Shadow().hand, Shadow().object, Config(GetParam()), GraspPosture(Shadow().hand),
                GraspObjectPose());
    world.SetGravity(GraspGravity());
    RandomStream random(3, 0);
    JointVector torque = JointVector::Zero(Shadow().hand.num_joints());
    double drift = 0;
    for (int k = 0; k < 2000; ++k) {
      if (k % hold == 0)
        for (int i = 0; i < torque.size(); ++i)
          torque[i] = (random.Uniform() < 0.5 ? -1 : 1) * Shadow().hand.joints[i].effort;
      world.SetTorque(torque);
      ASSERT_EQ(world.Step(), StepStatus::kOk) << "tick " << k << ": " << world.fault_message();
      drift = std::max(drift, world.JointDrift());
    }
    // Joints may give by millimetres under ten times the torque of a grasp, but must not come
    // apart.
    EXPECT_LT(drift, 5e-3) << "held for " << hold;
    RecordProperty("drift_um_" + std::to_string(hold), static_cast<int>(1e6 * drift));
    // And it comes to rest again.
    for (int k = 0; k < 2000; ++k) {
      world.SetTorque(Compensation(world));
      ASSERT_EQ(world.Step(), StepStatus::kOk) << world.fault_message();
    }
    EXPECT_LT(world.JointDrift(), 30e-6);
    EXPECT_LT(world.state().qdot.cwiseAbs().maxCoeff(), 0.1);
  }
}

TEST(World, HashSeesEveryInput) {
  const auto hash_after = [](auto change) {
    World world(Cradle(0.025), Sphere(), {}, JointVector(0), At(0, 0, 0));
    change(world);
    return HashOf(world);
  };
  const std::uint64_t plain = hash_after([](World&) {});
  EXPECT_EQ(hash_after([](World&) {}), plain);
  EXPECT_NE(hash_after([](World& w) { w.SetPush(Vector3d(0, 0, 1e-9)); }), plain);
  EXPECT_NE(hash_after([](World& w) { w.SetGravity(Vector3d(0, 0, 1e-9)); }), plain);
  EXPECT_NE(hash_after([](World& w) { w.SetFriction(0.79); }), plain);
  EXPECT_NE(hash_after([](World& w) { w.SetMass(0.081); }), plain);
  EXPECT_NE(hash_after([](World& w) { w.SetStandIn(false); }), plain);
}

TEST(World, FaultsAreFinalAndTheProcessLives) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const JointVector q0 = GraspPosture(Shadow().hand);
  for (int round = 0; round < 50; ++round) {
    World world(Shadow().hand, Shadow().object, {}, q0, GraspObjectPose());
    ASSERT_EQ(world.Step(), StepStatus::kOk);
    JointVector torque = JointVector::Zero(Shadow().hand.num_joints());
    torque[round % torque.size()] = nan;
    world.SetTorque(torque);
    EXPECT_EQ(world.Step(), StepStatus::kFault);
    EXPECT_STRNE(world.fault_message(), "");
    world.SetTorque(JointVector::Zero(torque.size()));
    EXPECT_EQ(world.Step(), StepStatus::kFault) << "a fault is for ever";
  }
}

TEST_P(EachStepper, AbsurdForcesInsideOdeAreFaults) {
  // Finite at the door, but infinite or NaN once ODE has multiplied: its own checks or ours must
  // see it.
  for (const double force : {1e30, 1e150, 1e300, 1.7e308}) {
    Holding holding(Config(GetParam()));
    holding.world->SetPush(Vector3d(force, force, -force));
    StepStatus status = StepStatus::kOk;
    for (int k = 0; k < 20 && status == StepStatus::kOk; ++k) status = holding.world->Step();
    EXPECT_EQ(status, StepStatus::kFault) << force;
  }
  Holding fresh(Config(GetParam()));  // and a new world works
  EXPECT_EQ(fresh.world->state().contacts.size(), 5u);
}

// Bytes that malloc has handed out and not got back, without what it keeps for itself.
long BytesInUse() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<long>(info.uordblks + info.hblkhd);
}

TEST_P(EachStepper, FaultsDoNotAddUp) {
  if (!CountsAllocations()) GTEST_SKIP() << "a sanitizer owns malloc";
  const auto cycle = [&](int k) {
    World world(Shadow().hand, Shadow().object, Config(GetParam()), GraspPosture(Shadow().hand),
                GraspObjectPose());
    world.SetStandIn(false);
    ASSERT_EQ(world.Step(), StepStatus::kOk);
    if (k % 3 == 0) world.SetPush(Vector3d(1e30, 0, 0));
    if (k % 3 == 1) world.SetMass(1e-300);
    if (k % 3 == 2)
      world.SetTorque(JointVector::Constant(Shadow().hand.num_joints(),
                                            std::numeric_limits<double>::infinity()));
    StepStatus status = StepStatus::kOk;
    for (int n = 0; n < 20 && status == StepStatus::kOk; ++n) status = world.Step();
    EXPECT_EQ(status, StepStatus::kFault) << k;
  };
  for (int k = 0; k < 30; ++k) cycle(k);
  const long before = BytesInUse();
  for (int k = 0; k < 300; ++k) cycle(k);
  // A world is at least 100 kB; 300 worlds left behind would be 30 MB.
  EXPECT_LT(BytesInUse() - before, 100000);
}

TEST(World, MalformedInputsAreFaults) {
  const auto status_after = [](auto change) {
    World world(Cradle(0.025), Sphere(), {}, JointVector(0), At(0, 0, 0));
    change(world);
    return world.Step();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status_after([](World&) {}), StepStatus::kOk);
  EXPECT_EQ(status_after([=](World& w) { w.SetPush(Vector3d(0, nan, 0)); }), StepStatus::kFault);
  EXPECT_EQ(status_after([=](World& w) { w.SetGravity(Vector3d(0, nan, 0)); }), StepStatus::kFault);
  EXPECT_EQ(status_after([=](World& w) { w.SetMass(nan); }), StepStatus::kFault);
  EXPECT_EQ(status_after([](World& w) { w.SetMass(0); }), StepStatus::kFault);
  EXPECT_EQ(status_after([=](World& w) { w.SetFriction(nan); }), StepStatus::kFault);
  EXPECT_EQ(status_after([](World& w) { w.SetTorque(JointVector::Zero(3)); }), StepStatus::kFault);
}

TEST_P(EachStepper, StepAllocatesNothing) {
  if (!CountsAllocations()) GTEST_SKIP() << "a sanitizer owns malloc";
  Holding holding(Config(GetParam()));
  World& world = *holding.world;
  const JointVector torque = Grasp(world, &holding.rest, false);
  const long before = AllocationCount();
  for (int k = 0; k < 500; ++k) {
    world.SetTorque(torque);
    world.SetStandIn(k >= 100 && k < 200);
    world.SetMass(k < 300 ? 0.08 : 0.09);
    world.Step();
  }
  EXPECT_EQ(AllocationCount() - before, 0);
}

}  // namespace
}  // namespace regrasp
