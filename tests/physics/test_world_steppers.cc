// The fast stepper against the exact one; the same bits from the same input.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>
#include <vector>

#include "core/common/random.h"
#include "core/world/stepper_choice.h"
#include "tests/physics/world_models.h"

namespace regrasp {
namespace {

/// Torques of either sign for 0.3 s, far from any object.
void Drive(World* world) {
  JointVector torque(Shadow().hand.num_joints());
  for (int i = 0; i < torque.size(); ++i) torque[i] = 0.02 * (i % 2 ? 1 : -1);
  world->SetGravity(GraspGravity());
  world->SetTorque(torque);
  for (int k = 0; k < 300; ++k) ASSERT_EQ(world->Step(), StepStatus::kOk);
}

// As a daemon does that restores by executing again while it simulates. ODE's own threading, which
// all worlds share by default, ends the process then.
TEST_P(EachStepper, WorldsStepSideBySideInTwoThreads) {
  const auto run = [] {
    World world(Shadow().hand, Shadow().object, Config(GetParam()), GraspPosture(Shadow().hand),
                At(0, -0.5, 0));
    for (int k = 0; k < 3; ++k) Drive(&world);
    return world.state().q;
  };
  const JointVector alone = run();
  std::vector<std::future<JointVector>> side_by_side;
  for (int k = 0; k < 4; ++k) side_by_side.push_back(std::async(std::launch::async, run));
  for (auto& q : side_by_side) EXPECT_EQ(q.get(), alone);
}

TEST(World, MergedAndPlainHandMoveAlike) {
  const JointVector q0 = GraspPosture(Shadow().hand);
  WorldConfig merged = Config(Stepper::kExact), plain = merged;
  plain.merge_universal = false;
  World a(Shadow().hand, Shadow().object, merged, q0, At(0, -0.5, 0));
  World b(Shadow().hand, Shadow().object, plain, q0, At(0, -0.5, 0));
  for (World* world : {&a, &b}) ASSERT_NO_FATAL_FAILURE(Drive(world));
  const double moved = (a.state().q - q0).cwiseAbs().maxCoeff();
  EXPECT_GT(moved, 0.1);
  // They differ in where the rotors of merged joints act while the parent moves, and by the inertia
  // of the links that were lumped: 2 % of the motion.
  EXPECT_LT((a.state().q - b.state().q).cwiseAbs().maxCoeff(), 0.02 * moved);
}

// Both steppers solve the same equations, one in joint coordinates, one body by body.
void ExpectAlike(const WorldState& a, const WorldState& b, double angle, double length) {
  EXPECT_LT((a.q - b.q).cwiseAbs().maxCoeff(), angle);
  EXPECT_LT((a.p_WO - b.p_WO).norm(), length);
  EXPECT_LT(a.q_WO.angularDistance(b.q_WO), angle);
}

TEST(World, FreeHandMovesAlikeWithBothSteppers) {
  for (const bool merge : {true, false}) {
    const JointVector q0 = GraspPosture(Shadow().hand);
    WorldConfig fast = Config(Stepper::kFast), exact = Config(Stepper::kExact);
    fast.merge_universal = exact.merge_universal = merge;
    World a(Shadow().hand, Shadow().object, fast, q0, At(0, -0.5, 0));
    World b(Shadow().hand, Shadow().object, exact, q0, At(0, -0.5, 0));
    for (World* world : {&a, &b}) ASSERT_NO_FATAL_FAILURE(Drive(world));
    const double moved = (a.state().q - q0).cwiseAbs().maxCoeff();
    EXPECT_GT(moved, 0.1);
    // Bodies that turn about joints leave them by h² w² r / 2 per step and are drawn back: some
    // 1e-6 of the motion; links that knock on each other multiply it.
    ExpectAlike(a.state(), b.state(), 1e-3 * moved, 1e-9);
  }
}

TEST(World, HeldBallMovesAlikeWithBothSteppers) {
  Holding fast(Config(Stepper::kFast)), exact(Config(Stepper::kExact));
  for (Holding* holding : {&fast, &exact}) {
    holding->world->SetPush(Vector3d(0.3, 0.2, -0.2));
    for (int k = 0; k < 300; ++k) holding->Tick();
  }
  // The ball yields by .8 mm. The friction bounds differ: dWorldStep takes them from the normal
  // forces that there would be without friction.
  ExpectAlike(fast.world->state(), exact.world->state(), 5e-3, 5e-5);
  ASSERT_EQ(fast.world->state().contacts.size(), exact.world->state().contacts.size());
  for (std::size_t i = 0; i < fast.world->state().contacts.size(); ++i)
    EXPECT_LT(
        (fast.world->state().contacts[i].force_W - exact.world->state().contacts[i].force_W).norm(),
        0.05);
}

TEST_P(EachStepper, HeldContactsDoNotCreep) {
  Holding holding(Config(GetParam()));
  for (int k = 0; k < 2000; ++k) holding.Tick();
  const auto points = [&] {
    std::vector<Vector3d> p_OC;
    const WorldState& now = holding.world->state();
    for (const ObjectContact& c : now.contacts)
      p_OC.push_back(now.q_WO.conjugate() * (c.p_WC - now.p_WO));
    return p_OC;
  };
  const std::vector<Vector3d> before = points();
  const int ticks = 4000;
  for (int k = 0; k < ticks; ++k) holding.Tick();
  const std::vector<Vector3d> after = points();
  ASSERT_EQ(before.size(), 5u);
  ASSERT_EQ(after.size(), 5u);
  for (std::size_t i = 0; i < after.size(); ++i)
    EXPECT_LT((after[i] - before[i]).norm() / (ticks * kDt), 2e-6)
        << "the requirement, contact " << i;
}

TEST_P(EachStepper, EqualInputsGiveEqualBitsEvenInterleaved) {
  const JointVector q0 = GraspPosture(Shadow().hand);
  const auto make = [&](double mass) {
    auto world = std::make_unique<World>(Shadow().hand, Shadow().object, Config(GetParam()), q0,
                                         GraspObjectPose());
    world->SetGravity(GraspGravity());
    world->SetMass(mass);
    return world;
  };
  const auto tick = [](World& world, JointVector& rest, int k) {
    world.SetTorque(Grasp(world, &rest, k < 500));
    if (k == 600) world.SetStandIn(false);
    ASSERT_EQ(world.Step(), StepStatus::kOk);
  };
  auto alone = make(0.08);
  JointVector rest_alone = q0;
  for (int k = 0; k < 1000; ++k) tick(*alone, rest_alone, k);
  const std::uint64_t expected = HashOf(*alone);

  auto first = make(0.08), second = make(0.08), other = make(0.09);
  JointVector rest_first = q0, rest_second = q0, rest_other = q0;
  for (int k = 0; k < 1000; ++k) {
    tick(*first, rest_first, k);
    tick(*other, rest_other, k);
    tick(*second, rest_second, k);
  }
  EXPECT_EQ(HashOf(*first), expected);
  EXPECT_EQ(HashOf(*second), expected);
  EXPECT_NE(HashOf(*other), expected);
}

// Mounted turned by right angles, an axis lies where ODE's other axis is by default.
TEST_P(EachStepper, BuildsAUniversalJointWhicheverWayItsAxesPoint) {
  HandModel hand = Pendulum(1e-4, 0.01);
  Link knuckle;
  knuckle.name = "knuckle";
  knuckle.parent_joint = 0;
  knuckle.mass = 0.01;
  knuckle.I_LCom = 1e-6 * Matrix3d::Identity();
  hand.links.insert(hand.links.begin() + 1, knuckle);
  hand.links[2].parent_joint = 1;
  hand.joints.push_back(hand.joints[0]);
  hand.joints[1].name = "second";
  hand.joints[1].parent_link = 1;
  hand.joints[1].child_link = 2;
  hand.joints[1].X_PJ = Isometry3d::Identity();
  const Vector3d axes[] = {Vector3d::UnitX(),  Vector3d::UnitY(),  Vector3d::UnitZ(),
                           -Vector3d::UnitX(), -Vector3d::UnitY(), -Vector3d::UnitZ()};
  WorldConfig config = Config(GetParam()), hinges = config;
  hinges.merge_universal = false;
  for (const double turn : {0.0, 90.0, 180.0, -90.0})
    for (const Vector3d& mount : {axes[0], axes[1], axes[2]})
      for (const Vector3d& first : axes)
        for (const Vector3d& second : axes) {
          if (std::abs(first.dot(second)) > 0.5) continue;
          hand.joints[0].X_PJ.linear() =
              Eigen::AngleAxisd(turn * std::numbers::pi / 180, mount).toRotationMatrix();
          hand.joints[0].axis_J = first;
          hand.joints[1].axis_J = second;
          const JointVector q0 = JointVector::Zero(2);
          World world(hand, Sphere(), config, q0, At(1, 0, 0));
          World other(hand, Sphere(), hinges, q0, At(1, 0, 0));
          for (World* w : {&world, &other}) w->SetGravity({0, 0, -kG});
          for (int k = 0; k < 30; ++k)
            for (World* w : {&world, &other}) ASSERT_EQ(w->Step(), StepStatus::kOk);
          // The knuckle's inertia counts as the parent's.
          EXPECT_LT((world.state().q - other.state().q).norm(),
                    0.02 * other.state().q.norm() + 1e-6)
              << turn << " about " << mount.transpose() << ", axes " << first.transpose() << " and "
              << second.transpose();
        }
}

TEST(StepperChoice, TakesTheFastStepForAHandWhereBothAgree) {
  const StepperChoice choice = ChooseStepper(Shadow(), {});
  EXPECT_EQ(choice.stepper, Stepper::kFast) << choice.reason;
  EXPECT_TRUE(choice.reason.starts_with("passed at load: closing the hand, ")) << choice.reason;
  EXPECT_EQ(ChooseStepper(Shadow(), {}).reason, choice.reason) << "deterministic";
  WorldConfig hinges;
  hinges.merge_universal = false;
  EXPECT_EQ(ChooseStepper(Shadow(), hinges).stepper, Stepper::kFast);
}

TEST(StepperChoice, TakesTheFastStepForAHandThatIsClosedFromTheBeginning) {
  LoadedScenario still = Shadow();
  still.scenario.q_closed = still.scenario.q_preshape;
  const StepperChoice choice = ChooseStepper(still, {});
  EXPECT_EQ(choice.stepper, Stepper::kFast) << choice.reason;
}

TEST(StepperChoice, SaysWhereNeitherStepMovesTheHand) {
  LoadedScenario dust = Shadow();
  for (Link& link : dust.hand.links) link.mass = 1e-11, link.I_LCom = 1e-19 * Matrix3d::Identity();
  for (Joint& joint : dust.hand.joints) joint.armature = joint.damping = 0;
  const StepperChoice choice = ChooseStepper(dust, {});
  EXPECT_FALSE(choice.works) << choice.reason;
  EXPECT_TRUE(choice.reason.starts_with("neither step can close the hand: the exact one: "));
  EXPECT_EQ(choice.reason.find("--stepper"), std::string::npos) << choice.reason;
  EXPECT_TRUE(ChooseStepper(Shadow(), {}).works);
}

TEST(StepperChoice, TakesTheExactStepWhereTheFastOneIsOff) {
  WorldConfig broken;
  broken.contact_solver.max_sweeps = 0;  // contact forces stay zero: through the object
  const StepperChoice choice = ChooseStepper(Shadow(), broken);
  EXPECT_EQ(choice.stepper, Stepper::kExact) << choice.reason;
  EXPECT_TRUE(choice.reason.starts_with("failed at load: closing the hand, ")) << choice.reason;
}

}  // namespace
}  // namespace regrasp
