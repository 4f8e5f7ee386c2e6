/// Coupled joints in the simulation, and objects that begin inside a link.

#include <gtest/gtest.h>

#include <cmath>

#include "core/hand/kinematics.h"
#include "core/world/start_overlap.h"
#include "core/world/world.h"

namespace regrasp {
namespace {

/// Two rods of 40 mm in a row, the second turning `ratio` times as far as the first.
HandModel CoupledFinger(double ratio) {
  HandModel hand;
  hand.name = "coupled";
  hand.num_coupled = 1;
  hand.links.resize(3);
  hand.joints.resize(2);
  for (int j = 0; j < 2; ++j) {
    Joint& joint = hand.joints[j];
    joint.name = j == 0 ? "A" : "B";
    joint.parent_link = j;
    joint.child_link = j + 1;
    joint.X_PJ.translation().z() = j == 0 ? 0 : 0.04;
    joint.lower = -1.5;
    joint.upper = 1.5;
    joint.effort = 2;
    joint.damping = 0.01;
    joint.armature = 2e-4;
    Link& link = hand.links[j + 1];
    link.name = joint.name;
    link.parent_joint = j;
    link.mass = 0.03;
    link.p_LCom.z() = 0.02;
    link.I_LCom = Vector3d(4e-6, 4e-6, 1e-6).asDiagonal();
  }
  hand.joints[1].driver = 0;
  hand.joints[1].ratio = ratio;
  Shape tip;
  tip.b_L.z() = 0.04;
  tip.radius = 0.005;
  hand.links[2].shapes = {tip};
  hand.fingers.push_back({"only", {0}, 2, tip.b_L, tip.radius});
  return hand;
}

ObjectModel FarBall() {
  ObjectModel ball;
  ball.I_OCom = 2e-5 * Matrix3d::Identity();
  return ball;
}

Isometry3d At(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

TEST(CoupledJoint, IsHeldByTheTorqueThatItsDriverBears) {
  // The gravity torque counts the second link at `ratio`; a transmission that passed anything else
  // would let the finger fall or rise.
  for (const Stepper stepper : {Stepper::kFast, Stepper::kExact})
    for (const double ratio : {0.5, 1.0, -0.7, 1.45}) {
      SCOPED_TRACE(ratio);
      const HandModel hand = CoupledFinger(ratio);
      WorldConfig config;
      config.stepper = stepper;
      const Vector3d gravity(0, 9.81, 0);
      const JointVector q0 = JointVector::Constant(1, -0.6);  // where gravity holds it
      World world(hand, FarBall(), config, q0, At(0, 1, 0));
      world.SetGravity(gravity);
      KinematicsData data;
      ForwardKinematics(hand, q0, &data);
      world.SetTorque(GravityTorque(hand, data, gravity));
      for (int i = 0; i < 1000; ++i) ASSERT_EQ(world.Step(), StepStatus::kOk);
      // The spring yields by its load of at most 0.03 kg g 20 mm = 6e-3 N m over 20 N m/rad, 3e-4
      // rad, which moves the load's arm by little; the rest is friction of the solver.
      EXPECT_NEAR(world.state().q[0], -0.6, 3e-3);
      EXPECT_LT(std::abs(world.state().qdot[0]), 1e-3);
    }
}

TEST(CoupledJoint, OnACarriedDriverWithStrongDampingMovesAlikeInBothSteppers) {
  // Light links whose inertia is the armature, as published hands have; the exact step's
  // transmission must not be stiffer than they bear.
  for (const double damping : {0.02, 0.05, 0.1, 0.3})
    for (const double ratio : {1.0, 1.45, -1.0}) {
      SCOPED_TRACE(testing::Message() << damping << " " << ratio);
      HandModel hand = CoupledFinger(ratio);
      // The finger stands on a joint of its own, and a second follower on the first.
      hand.links.insert(hand.links.begin() + 1, hand.links[1]);
      hand.joints.insert(hand.joints.begin(), hand.joints[0]);
      hand.links.push_back(hand.links[3]);
      hand.joints.push_back(hand.joints[2]);
      hand.num_coupled = 2;
      for (int j = 0; j < 4; ++j) {
        hand.joints[j].parent_link = j;
        hand.joints[j].child_link = j + 1;
        hand.joints[j].X_PJ.translation().z() = j == 0 ? 0 : 0.03;
        hand.joints[j].damping = damping;
        hand.joints[j].driver = j < 2 ? -1 : 1;
        hand.links[j + 1].parent_joint = j;
        hand.links[j + 1].mass = 0.01;
        hand.links[j + 1].I_LCom = Vector3d(8e-7, 8e-7, 3e-7).asDiagonal();
      }
      hand.fingers[0].joints = {0, 1};
      hand.fingers[0].tip_link = 4;
      JointVector q[2];
      for (const Stepper stepper : {Stepper::kFast, Stepper::kExact}) {
        WorldConfig config;
        config.stepper = stepper;
        World world(hand, FarBall(), config, JointVector::Zero(2), At(0, 1, 0));
        world.SetGravity(Vector3d::Zero());
        for (int k = 0; k < 300; ++k) {
          world.SetTorque(JointVector::Constant(2, 0.5) - world.state().q);
          ASSERT_EQ(world.Step(), StepStatus::kOk) << k << ": " << world.fault_message();
        }
        q[stepper == Stepper::kExact] = world.state().q;
      }
      EXPECT_GT(q[0].maxCoeff(), 0.1);
      // The elastic transmission gives way by some per cent while it accelerates.
      EXPECT_LT((q[0] - q[1]).cwiseAbs().maxCoeff(), 0.05 * q[0].cwiseAbs().maxCoeff());
    }
}

TEST(CoupledJoint, StopsAtTheFollowersLimitAndStaysThere) {
  HandModel hand = CoupledFinger(1.0);
  hand.joints[1].upper = 0.5;  // the loader narrows the driver; here the follower's own stop acts
  World world(hand, FarBall(), WorldConfig(), JointVector::Constant(1, 0.2), At(0, 1, 0));
  world.SetTorque(JointVector::Constant(1, 0.05));
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(world.Step(), StepStatus::kOk);
  // The follower's stop yields by 0.05 N m over 20 N m/rad; the coupling is rigid.
  EXPECT_NEAR(world.state().q[0], 0.5025, 1e-4);
}

TEST(Contacts, OfMoreThanFitTheDeepestAreKept) {
  HandModel hand = CoupledFinger(1.0);
  // Beads of 2 mm around the ball, each pressed in deeper than the one before; far from the finger.
  constexpr int kBeads = kMaxObjectContacts + 6;
  const ObjectModel ball = FarBall();
  const Vector3d p_WO(0, 1, 0);
  const auto depth = [](int i) { return 1e-5 * (i + 1); };
  for (int i = 0; i < kBeads; ++i) {
    const double angle = 2 * M_PI * i / kBeads;
    Shape bead;
    bead.radius = 0.002;
    bead.a_L = bead.b_L = p_WO + (ball.radius + bead.radius - depth(i)) *
                                     Vector3d(std::cos(angle), std::sin(angle), 0);
    hand.links[0].shapes.push_back(bead);
  }
  World world(hand, ball, WorldConfig(), JointVector::Zero(1), At(0, 1, 0));
  ASSERT_EQ(world.Step(), StepStatus::kOk);
  const auto& contacts = world.state().contacts;
  ASSERT_EQ(contacts.size(), static_cast<std::size_t>(kMaxObjectContacts));
  for (int k = 0; k < kMaxObjectContacts; ++k)  // in their order
    EXPECT_NEAR(contacts[static_cast<std::size_t>(k)].depth, depth(k + 6), 1e-9) << k;
}

/// A knob of 5 mm beside the fingertip, on its link.
HandModel FingerWithKnob() {
  HandModel hand = CoupledFinger(1.0);
  Shape knob;
  knob.radius = 0.005;
  knob.a_L = knob.b_L = Vector3d(0, -0.02, 0.02);
  hand.links[2].shapes.push_back(knob);
  return hand;
}

TEST(Contacts, OfATipLinkOnlyTheFingertipsShapesAreTheFingers) {
  HandModel hand = FingerWithKnob();
  for (const Stepper stepper : {Stepper::kFast, Stepper::kExact})
    for (const auto& [y, finger] : {std::pair{0.0295, 0}, {-0.0495, -1}}) {
      WorldConfig config;
      config.stepper = stepper;
      World world(hand, FarBall(), config, JointVector::Zero(1), At(0, y, 0.06));
      ASSERT_EQ(world.Step(), StepStatus::kOk);
      const auto& contacts = world.state().contacts;
      ASSERT_EQ(contacts.size(), 1u) << y;
      EXPECT_EQ(contacts[0].link, 2);
      EXPECT_EQ(contacts[0].finger, finger);
    }
  hand.fingers[0].tip_shapes = 2;
  World world(hand, FarBall(), WorldConfig(), JointVector::Zero(1), At(0, -0.0495, 0.06));
  ASSERT_EQ(world.Step(), StepStatus::kOk);
  ASSERT_EQ(world.state().contacts.size(), 1u);
  EXPECT_EQ(world.state().contacts[0].finger, 0);
}

TEST(WorldMemory, ContactsBesideAFingertipAreThoseOfNoFinger) {
  const HandModel hand = FingerWithKnob();
  World world(hand, FarBall(), WorldConfig(), JointVector::Zero(1), At(0, 1, 0));
  WorldMemory memory = world.Memory();
  ObjectContact contact;
  contact.link = 2;
  memory.state.contacts.push_back(contact);
  EXPECT_TRUE(world.Remember(memory));
  memory.state.contacts[0].finger = 1;
  EXPECT_FALSE(world.Remember(memory));
}

TEST(WorldMemory, ContactsOfNoLinkOfTheHandAreRefused) {
  const HandModel hand = CoupledFinger(1.0);
  World world(hand, FarBall(), WorldConfig(), JointVector::Zero(1), At(0, 1, 0));
  WorldMemory memory = world.Memory();
  ObjectContact contact;
  contact.link = 2;
  contact.finger = 0;
  memory.state.contacts.push_back(contact);
  EXPECT_TRUE(world.Remember(memory));
  for (const auto& [link, finger] :
       {std::pair{3, 0}, {32, -1}, {-1, -1}, {1, 0}, {2, -1}, {2, 1}}) {
    memory.state.contacts[0].link = link;
    memory.state.contacts[0].finger = finger;
    EXPECT_FALSE(world.Remember(memory)) << link << " " << finger;
    EXPECT_EQ(world.state().contacts[0].link, 2);
  }
}

TEST(StartOverlap, IsTheDepthOfTheDeepestLink) {
  const HandModel hand = CoupledFinger(1.0);
  KinematicsData data;
  ForwardKinematics(hand, JointVector::Zero(1), &data);
  const std::vector<Isometry3d> X_WL(data.X_WL.begin(), data.X_WL.begin() + 3);
  const ObjectModel ball = FarBall();  // 25 mm; the tip's capsule: z from 40 to 80 mm, 5 mm
  EXPECT_EQ(DeepestOverlap(hand, X_WL, ball, At(0, 0.0301, 0.06)).link, -1);
  const StartOverlap touching = DeepestOverlap(hand, X_WL, ball, At(0, 0.02, 0.06));
  EXPECT_EQ(touching.link, 2);
  EXPECT_NEAR(touching.depth, 0.010, 1e-9);
  // The same as a box, and a link as a box in it.
  ObjectModel box = ball;
  box.kind = ObjectModel::Kind::kBox;
  box.half_extents = Vector3d::Constant(0.025);
  box.bounding_radius = box.half_extents.norm();
  EXPECT_NEAR(DeepestOverlap(hand, X_WL, box, At(0, 0.02, 0.06)).depth, 0.010, 1e-9);
  HandModel palm = hand;
  Shape plate;
  plate.kind = Shape::Kind::kBox;
  plate.half_extents = Vector3d(0.03, 0.01, 0.04);
  palm.links[0].shapes = {plate};
  const StartOverlap in_palm = DeepestOverlap(palm, X_WL, ball, At(0, 0.03, -0.01));
  EXPECT_EQ(in_palm.link, 0);
  EXPECT_NEAR(in_palm.depth, 0.005, 1e-9);
}

TEST(StartOverlap, SeesALinkDeepInsideAMesh) {
  ObjectModel brick = FarBall();
  brick.kind = ObjectModel::Kind::kMesh;
  for (int i = 0; i < 8; ++i)
    brick.vertices_O.emplace_back(0.1 * ((i & 1) - 0.5), 0.1 * (((i >> 1) & 1) - 0.5),
                                  0.1 * (((i >> 2) & 1) - 0.5));
  brick.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  brick.bounding_radius = 0.05 * std::sqrt(3.0);
  const HandModel hand = CoupledFinger(1.0);
  KinematicsData data;
  ForwardKinematics(hand, JointVector::Zero(1), &data);
  const std::vector<Isometry3d> X_WL(data.X_WL.begin(), data.X_WL.begin() + 3);
  // The capsule lies along the axis of the brick about (0, 0, 60 mm): 50 mm from four sides.
  EXPECT_NEAR(DeepestOverlap(hand, X_WL, brick, At(0, 0, 0.06)).depth, 0.055, 1e-9);
  EXPECT_EQ(DeepestOverlap(hand, X_WL, brick, At(0, 0.06, 0.06)).link, -1);
}

}  // namespace
}  // namespace regrasp
