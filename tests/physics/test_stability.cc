/// Hands whose joints are damped more strongly, or are lighter, than an explicit step can bear; and
/// hands with couplings across fingers. Nothing here may diverge, and both steppers must agree.

#include <gtest/gtest.h>

#include <cmath>

#include "core/world/stepper_choice.h"
#include "core/world/world.h"

namespace regrasp {
namespace {

struct Build {
  double damping = 0.2, armature = 2e-4;
  int fingers = 2, joints = 3;
  double link_mass = 0.02;
};

/// Fingers side by side, each a chain of rods of 30 mm with parallel axes.
HandModel Chains(const Build& build) {
  HandModel hand;
  hand.name = "chains";
  hand.links.resize(1);
  for (int f = 0; f < build.fingers; ++f) {
    Finger finger;
    finger.name = "f" + std::to_string(f);
    for (int k = 0; k < build.joints; ++k) {
      Joint joint;
      joint.name = finger.name + std::to_string(k);
      joint.parent_link = k == 0 ? 0 : static_cast<int>(hand.links.size()) - 1;
      joint.child_link = static_cast<int>(hand.links.size());
      joint.X_PJ.translation() = k == 0 ? Vector3d(0.05 * f, 0, 0) : Vector3d(0, 0, 0.03);
      joint.lower = -1;
      joint.upper = 1;
      joint.effort = 1;
      joint.damping = build.damping;
      joint.armature = build.armature;
      Link link;
      link.name = joint.name;
      link.parent_joint = static_cast<int>(hand.joints.size());
      link.mass = build.link_mass;
      link.p_LCom.z() = 0.015;
      link.I_LCom = build.link_mass * Vector3d(7.5e-5, 7.5e-5, 1.3e-5).asDiagonal();
      finger.joints.push_back(static_cast<int>(hand.joints.size()));
      hand.joints.push_back(joint);
      hand.links.push_back(link);
    }
    Shape tip;
    tip.b_L.z() = 0.03;
    tip.radius = 0.006;
    finger.tip_link = static_cast<int>(hand.links.size()) - 1;
    finger.p_LF = tip.b_L;
    finger.tip_radius = tip.radius;
    hand.links.back().shapes = {tip};
    hand.fingers.push_back(finger);
  }
  return hand;
}

/// Every joint of the second finger follows the one of the first: a coupling across chains.
HandModel Coupled(const Build& build, double ratio) {
  HandModel hand = Chains(build);
  hand.num_coupled = build.joints;
  for (int k = 0; k < build.joints; ++k) {
    hand.joints[static_cast<std::size_t>(build.joints + k)].driver = k;
    hand.joints[static_cast<std::size_t>(build.joints + k)].ratio = ratio;
    hand.joints[static_cast<std::size_t>(build.joints + k)].lower = -3;
    hand.joints[static_cast<std::size_t>(build.joints + k)].upper = 3;
  }
  hand.fingers[1].joints = hand.fingers[0].joints;
  return hand;
}

ObjectModel Ball() {
  ObjectModel ball;
  ball.I_OCom = 2e-5 * Matrix3d::Identity();
  return ball;
}

Isometry3d FarAway() { return Isometry3d(Eigen::Translation3d(0, 1, 0)); }

World MakeWorld(const HandModel& hand, Stepper stepper) {
  WorldConfig config;
  config.stepper = stepper;
  return World(hand, Ball(), config, JointVector::Constant(hand.num_joints(), 0.5), FarAway());
}

/// Ten seconds of falling: no joint may ever be faster than twice what gravity's torque on a whole
/// finger (60 g at 45 mm) makes of its damping. What diverges passes any bound.
void ExpectCalmFall(const HandModel& hand, Stepper stepper, double damping) {
  World world = MakeWorld(hand, stepper);
  world.SetGravity(Vector3d(0, 9.81, 0));
  double fastest = 0;
  for (int i = 0; i < 10000; ++i) {
    ASSERT_EQ(world.Step(), StepStatus::kOk) << world.fault_message();
    fastest = std::max(fastest, world.state().qdot.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(fastest, 2 * 0.06 * 9.81 * 0.045 / damping);
  EXPECT_GT((world.state().q.array() - 0.5).abs().maxCoeff(), 0.05) << "it fell";
}

TEST(StrongDamping, FallsCalmlyForTenSecondsWithEitherStepper) {
  for (const Stepper stepper : {Stepper::kFast, Stepper::kExact})
    for (const double damping : {0.1, 0.2, 2.0})
      for (const double armature : {2e-4, 1e-5}) {
        SCOPED_TRACE(damping);
        SCOPED_TRACE(armature);
        Build build;
        build.damping = damping;
        build.armature = armature;
        ExpectCalmFall(Chains(build), stepper, damping);
      }
}

TEST(StrongDamping, LetsAJointTurnAtItsTorqueOverItsDamping) {
  for (const Stepper stepper : {Stepper::kFast, Stepper::kExact}) {
    Build build;
    build.fingers = build.joints = 1;
    World world = MakeWorld(Chains(build), stepper);
    world.SetTorque(JointVector::Constant(1, -0.04));
    for (int i = 0; i < 500; ++i) ASSERT_EQ(world.Step(), StepStatus::kOk);
    EXPECT_NEAR(world.state().qdot[0], -0.2, 1e-5);  // the motion dies out with 1 ms
    EXPECT_NEAR(world.state().q[0], 0.5 - 0.2 * 0.5, 1e-3);
  }
}

TEST(StrongDamping, MovesAHandTheSameWayInBothSteppers) {
  World fast = MakeWorld(Chains({}), Stepper::kFast);
  World exact = MakeWorld(Chains({}), Stepper::kExact);
  for (World* world : {&fast, &exact}) {
    world->SetGravity(Vector3d(0, 9.81, 0));
    for (int i = 0; i < 1000; ++i) ASSERT_EQ(world->Step(), StepStatus::kOk);
  }
  EXPECT_GT(std::abs(fast.state().q[0] - 0.5), 0.05) << "it moved";
  EXPECT_LT((fast.state().q - exact.state().q).cwiseAbs().maxCoeff(), 2e-3);
}

TEST(LightJoint, IsStoppedAtItsLimitWithoutArmature) {
  Build build;
  build.armature = 0;
  build.link_mass = 0.002;
  build.damping = 0.001;
  World world = MakeWorld(Chains(build), Stepper::kFast);
  world.SetTorque(JointVector::Constant(6, 0.01));
  for (int i = 0; i < 5000; ++i) ASSERT_EQ(world.Step(), StepStatus::kOk) << world.fault_message();
  // The stop yields by 0.01 N m over 20 N m/rad.
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(world.state().q[j], 1.0005, 1e-4) << j;
}

TEST(CoupledAcrossFingers, FallsCalmlyForTenSeconds) {
  for (const double ratio : {1.0, 0.5, -1.3}) {
    SCOPED_TRACE(ratio);
    Build build;
    build.armature = 1e-5;
    ExpectCalmFall(Coupled(build, ratio), Stepper::kFast, build.damping);
  }
}

TEST(CoupledAcrossFingers, FallsLikeTheElasticTransmissionOfTheExactStep) {
  // Both fingers fall alike, so that one that follows the other falls as it would alone.
  Build build;
  build.damping = 0.02;
  World fast = MakeWorld(Coupled(build, 1.0), Stepper::kFast);
  World exact = MakeWorld(Coupled(build, 1.0), Stepper::kExact);
  World alone = MakeWorld(Chains(build), Stepper::kFast);
  for (World* world : {&fast, &exact, &alone}) {
    world->SetGravity(Vector3d(0, 9.81, 0));
    for (int i = 0; i < 300; ++i) ASSERT_EQ(world->Step(), StepStatus::kOk);
  }
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(fast.state().q[j], exact.state().q[j], 5e-3) << j;
    EXPECT_NEAR(fast.state().q[j], alone.state().q[j], 1e-9) << j;
  }
}

TEST(StepperChoice, TellsWhyForAStronglyDampedHand) {
  LoadedScenario model;
  model.hand = Chains({});
  model.object = Ball();
  model.scenario.q_preshape = JointVector::Constant(6, 0.2);
  model.scenario.q_closed = JointVector::Constant(6, 0.6);
  model.scenario.X_WO = FarAway();
  const StepperChoice choice = ChooseStepper(model, {});
  EXPECT_EQ(choice.stepper, Stepper::kFast) << choice.reason;
  EXPECT_FALSE(choice.reason.empty());
}

}  // namespace
}  // namespace regrasp
