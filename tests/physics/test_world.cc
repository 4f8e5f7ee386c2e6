#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/common/random.h"
#include "core/hand/kinematics.h"
#include "core/hand/scenario.h"
#include "core/world/stepper_choice.h"
#include "core/world/world.h"
#include "tests/physics/grasp_posture.h"
#include "tests/physics/malloc_counter.h"

// A world in which ODE has given up is left behind on purpose: it cannot be destroyed safely.
extern "C" const char* __lsan_default_suppressions() { return "leak:libode"; }

namespace regrasp {
namespace {

constexpr double kG = 9.81;
constexpr double kDt = 1e-3;

WorldConfig Config(Stepper stepper) {
  WorldConfig config;
  config.stepper = stepper;
  return config;
}

ObjectModel Sphere(double radius = 0.025, double mass = 0.08) {
  ObjectModel object;
  object.radius = object.bounding_radius = radius;
  object.mass = mass;
  object.I_OCom = 0.4 * mass * radius * radius * Matrix3d::Identity();
  return object;
}

ObjectModel Cube(double side = 0.04, double mass = 0.08) {
  ObjectModel object;
  object.kind = ObjectModel::Kind::kBox;
  object.half_extents = Vector3d::Constant(side / 2);
  object.bounding_radius = object.half_extents.norm();
  object.mass = mass;
  object.I_OCom = mass * side * side / 6 * Matrix3d::Identity();
  return object;
}

// A sphere made of triangles: an octahedron, each face split `levels` times.
ObjectModel MeshSphere(double radius, int levels) {
  ObjectModel object = Sphere(radius);
  object.kind = ObjectModel::Kind::kMesh;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  std::vector<std::array<Vector3d, 3>> faces = {{x, y, z},  {y, -x, z},  {-x, -y, z},  {-y, x, z},
                                                {y, x, -z}, {-x, y, -z}, {-y, -x, -z}, {x, -y, -z}};
  for (int level = 0; level < levels; ++level) {
    std::vector<std::array<Vector3d, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const Vector3d ab = (a + b).normalized(), bc = (b + c).normalized(),
                     ca = (c + a).normalized();
      finer.push_back({a, ab, ca});
      finer.push_back({ab, b, bc});
      finer.push_back({ca, bc, c});
      finer.push_back({ab, bc, ca});
    }
    faces = finer;
  }
  for (const auto& face : faces) {
    const int n = static_cast<int>(object.vertices_O.size());
    for (const Vector3d& v : face) object.vertices_O.push_back(radius * v);
    object.triangles.emplace_back(n, n + 1, n + 2);
  }
  return object;
}

Isometry3d At(double x, double y, double z) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(x, y, z);
  return X;
}

// A palm that is a slab with its top at z = 0; no joints.
HandModel Slab() {
  HandModel hand;
  hand.name = "slab";
  Link palm;
  palm.name = "palm";
  Shape box;
  box.kind = Shape::Kind::kBox;
  box.X_LB.translation() = Vector3d(0, 0, -0.05);
  box.half_extents = Vector3d(1, 1, 0.05);
  palm.shapes.push_back(box);
  hand.links.push_back(palm);
  return hand;
}

// A palm with three fingertip-like spheres on which a ball can lie.
HandModel Cradle(double ball_radius) {
  HandModel hand;
  hand.name = "cradle";
  Link palm;
  palm.name = "palm";
  for (int k = 0; k < 3; ++k) {
    const double a = 2 * std::numbers::pi * k / 3 + 0.3;
    Shape tip;
    tip.radius = 0.007;
    tip.a_L = Vector3d(0.6 * std::cos(a), 0.6 * std::sin(a), -0.8) * (ball_radius + tip.radius);
    // Lean outward, so that the ball touches the upper ends.
    tip.b_L = tip.a_L + 0.02 * tip.a_L.normalized();
    palm.shapes.push_back(tip);
  }
  hand.links.push_back(palm);
  return hand;
}

// One link on one hinge about x, hanging along -z at q = 0.
HandModel Pendulum(double armature, double damping) {
  HandModel hand;
  hand.name = "pendulum";
  Link palm;
  palm.name = "palm";
  Link bob;
  bob.name = "bob";
  bob.parent_joint = 0;
  bob.mass = 0.05;
  bob.p_LCom = Vector3d(0, 0, -0.04);
  bob.I_LCom = Vector3d(1e-5, 1e-5, 2e-6).asDiagonal();
  hand.links = {palm, bob};
  Joint joint;
  joint.name = "hinge";
  joint.parent_link = 0;
  joint.child_link = 1;
  joint.X_PJ.translation() = Vector3d(0.01, 0.02, 0.03);
  joint.lower = -1;
  joint.upper = 1;
  joint.effort = 0.5;
  joint.damping = damping;
  joint.armature = armature;
  hand.joints = {joint};
  return hand;
}

const LoadedScenario& Shadow() {
  static const LoadedScenario scenario = LoadScenario("shadow", "sphere", ModelSearchPath());
  return scenario;
}

JointVector Compensation(const World& world) {
  KinematicsData data;
  ForwardKinematics(Shadow().hand, world.state().q, &data);
  return GravityTorque(Shadow().hand, data, world.gravity_W());
}

// Presses all fingers on the object with 1 N towards its centre, springs of 3 N m/rad about `rest`,
// which follows while `creep`.
JointVector Grasp(const World& world, JointVector* rest, bool creep) {
  const HandModel& hand = Shadow().hand;
  const WorldState& now = world.state();
  KinematicsData data;
  ForwardKinematics(hand, now.q, &data);
  JointVector torque = GravityTorque(hand, data, world.gravity_W());
  if (creep) *rest += 0.1 * (now.q - *rest);
  torque += 3.0 * (*rest - now.q);
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const Vector3d p = FingertipCentre(hand, data, f);
    const FingerVector t =
        PointJacobian(hand, data, f, p).transpose() * (now.p_WO - p).normalized();
    for (std::size_t k = 0; k < hand.fingers[f].joints.size(); ++k)
      torque[hand.fingers[f].joints[k]] += t[k];
  }
  return torque;
}

// The hand closed on the sphere and the stand-in gone.
struct Holding {
  std::unique_ptr<World> world;
  JointVector rest;
  explicit Holding(const WorldConfig& config) {
    const JointVector q0 = GraspPosture(Shadow().hand);
    world = std::make_unique<World>(Shadow().hand, Shadow().object, config, q0, GraspObjectPose());
    world->SetGravity(GraspGravity());
    rest = q0;
    for (int k = 0; k < 1500; ++k) Tick(k < 1000);
    world->SetStandIn(false);
    for (int k = 0; k < 1500; ++k) Tick();
  }
  void Tick(bool creep = false) {
    world->SetTorque(Grasp(*world, &rest, creep));
    ASSERT_EQ(world->Step(), StepStatus::kOk) << world->fault_message();
  }
};

Vector3d TotalContactForce(const World& world) {
  Vector3d sum = Vector3d::Zero();
  for (const ObjectContact& contact : world.state().contacts) sum += contact.force_W;
  return sum;
}

std::uint64_t HashOf(const World& world) {
  StateHasher hasher;
  HashFields(world, &hasher);
  return hasher.Digest();
}

class BothSteppers : public testing::TestWithParam<Stepper> {};
INSTANTIATE_TEST_SUITE_P(World, BothSteppers, testing::Values(Stepper::kFast, Stepper::kExact),
                         [](const auto& p) {
                           return p.param == Stepper::kFast ? "Fast" : "Exact";
                         });

TEST_P(BothSteppers, FreeFallIsSemiImplicitEuler) {
  World world(Slab(), Sphere(), Config(GetParam()), JointVector(0), At(0, 0, 3));
  world.SetGravity(Vector3d(0, 0, -kG));
  world.SetStandIn(false);
  const int n = 500;
  for (int k = 0; k < n; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
  const double fallen = 3 - world.state().p_WO.z();
  // v_k = g h k, p_k = p_{k-1} - h v_k. 1e-9: rounding of 500 additions at 3 m is 500 * 4e-16.
  EXPECT_NEAR(fallen, kG * kDt * kDt * n * (n + 1) / 2, 1e-9);
  // The discrete sum exceeds g t²/2 by 1/n = 0.2 %.
  const double t = n * kDt;
  EXPECT_NEAR(fallen, kG * t * t / 2, 0.02 * kG * t * t / 2);
}

TEST_P(BothSteppers, StandInHoldsAgainstGravityAndPush) {
  World world(Slab(), Sphere(), Config(GetParam()), JointVector(0), At(0, 0, 1));
  world.SetGravity(Vector3d(0, 0, -kG));
  world.SetPush(Vector3d(5, 0, 0));
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
  // A fixed joint sags by what one step of ERP leaves: h² g plus h² F/m, some 1e-4 m at most.
  EXPECT_LT((world.state().p_WO - Vector3d(0, 0, 1)).norm(), 2e-4);
  world.SetStandIn(false);
  world.SetPush(Vector3d::Zero());
  for (int k = 0; k < 100; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
  EXPECT_LT(world.state().p_WO.z(), 1 - 0.04);
}

TEST_P(BothSteppers, PushIsForceOverMass) {
  World world(Slab(), Sphere(0.025, 0.08), Config(GetParam()), JointVector(0), At(0, 0, 1));
  world.SetStandIn(false);
  world.SetMass(0.2);
  world.SetPush(Vector3d(0.3, 0, 0));
  for (int k = 0; k < 100; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
  EXPECT_NEAR(world.state().v_WO.x(), 0.3 / 0.2 * 100 * kDt, 1e-12);
}

TEST_P(BothSteppers, CubeSticksBelowTheFrictionAngle) {
  World world(Slab(), Cube(), Config(GetParam()), JointVector(0), At(0, 0, 0.02));
  const double mu = 0.5, angle = std::atan(mu) - 0.05;
  world.SetFriction(mu);
  world.SetGravity(kG * Vector3d(std::sin(angle), 0, -std::cos(angle)));
  world.SetStandIn(false);
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
  // Sliding without friction would make it 2.1 m.
  EXPECT_LT(std::abs(world.state().p_WO.x()), 1e-3);
}

TEST_P(BothSteppers, CubeSlidesAboveTheFrictionAngle) {
  World world(Slab(), Cube(), Config(GetParam()), JointVector(0), At(-0.5, 0, 0.02));
  const double mu = 0.3, angle = std::atan(mu) + 0.2;
  world.SetFriction(mu);
  world.SetGravity(kG * Vector3d(std::sin(angle), 0, -std::cos(angle)));
  world.SetStandIn(false);
  for (int k = 0; k < 200; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);  // settles into the slab
  const double v0 = world.state().v_WO.x();
  for (int k = 0; k < 200; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
  const double acceleration = (world.state().v_WO.x() - v0) / (200 * kDt);
  // The pyramid's axes are aligned with the slope, where it equals the cone. 2 %: what is left of
  // the settling in the soft contact.
  const double expected = kG * (std::sin(angle) - mu * std::cos(angle));
  EXPECT_NEAR(acceleration, expected, 0.02 * expected);
}

TEST_P(BothSteppers, PendulumSwingsAtTheAnalyticFrequency) {
  for (const double armature : {0.0, 2e-4}) {
    const HandModel hand = Pendulum(armature, 0);
    JointVector q0(1);
    q0 << 0.05;
    World world(hand, Sphere(), Config(GetParam()), q0, At(0, 0, 1));
    world.SetGravity(Vector3d(0, 0, -kG));
    const Link& bob = hand.links[1];
    const double l = bob.p_LCom.norm();
    const double omega =
        std::sqrt(bob.mass * kG * l / (bob.I_LCom(0, 0) + bob.mass * l * l + armature));
    // Time of the tenth downward zero crossing, interpolated: (10 - 3/4) periods after the start.
    double before = world.state().q[0], crossing = 0, amplitude = 0;
    int found = 0;
    for (int k = 1; found < 10 && k < 20000; ++k) {
      ASSERT_EQ(world.Step(), StepStatus::kOk);
      const double now = world.state().q[0];
      if (found == 9) amplitude = std::max(amplitude, std::abs(now));
      if (before > 0 && now <= 0 && ++found == 10)
        crossing = kDt * (k - 1 + before / (before - now));
      before = now;
    }
    ASSERT_EQ(found, 10);
    // .05 %: 0.05 rad lengthens the period by 0.016 %, the step by less than 0.01 %.
    EXPECT_NEAR(crossing * omega / (2 * std::numbers::pi), 9.25, 0.0005 * 9.25)
        << "armature " << armature;
    // No damping: the swing must neither die nor grow (joint forces carried over between steps at
    // the wrong place once made it grow eightfold).
    EXPECT_NEAR(amplitude, 0.05, 0.01 * 0.05);
  }
}

TEST_P(BothSteppers, DriveTorqueIsClampedToTheEffort) {
  const HandModel hand = Pendulum(2e-4, 0.05);
  World world(hand, Sphere(), Config(GetParam()), JointVector::Zero(1), At(0, 0, 1));
  JointVector torque(1);
  torque << 100;
  world.SetTorque(torque);
  ASSERT_EQ(world.Step(), StepStatus::kOk);
  EXPECT_DOUBLE_EQ(world.state().torque[0], 0.5);
  // The first step starts at rest, so the rate is h tau / I.
  const Link& bob = hand.links[1];
  const double inertia = bob.I_LCom(0, 0) + bob.mass * bob.p_LCom.squaredNorm() + 2e-4;
  EXPECT_NEAR(world.state().qdot[0], kDt * 0.5 / inertia, 0.02 * kDt * 0.5 / inertia);
}

TEST_P(BothSteppers, JointStopCarriesTheDrive) {
  const HandModel hand = Pendulum(2e-4, 0.05);
  World world(hand, Sphere(), Config(GetParam()), JointVector::Zero(1), At(0, 0, 1));
  JointVector torque(1);
  torque << 0.5;
  world.SetTorque(torque);
  for (int k = 0; k < 2000; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
  // 0.5 N m on 20 N m/rad: 0.025 rad beyond the limit of 1 rad, at rest.
  EXPECT_NEAR(world.state().q[0], 1.025, 1e-4);
  EXPECT_NEAR(world.state().qdot[0], 0, 1e-4);
}

TEST_P(BothSteppers, StartPostureIsReproduced) {
  for (const bool merge : {true, false}) {
    WorldConfig config = Config(GetParam());
    config.merge_universal = merge;
    const JointVector q0 = GraspPosture(Shadow().hand);
    const World world(Shadow().hand, Shadow().object, config, q0, GraspObjectPose());
    EXPECT_LT((world.state().q - q0).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_EQ(world.state().qdot.norm(), 0);
    EXPECT_LT(world.JointDrift(), 1e-15);
  }
}

TEST_P(BothSteppers, HandUnderGravityCompensationStaysStill) {
  const JointVector q0 = GraspPosture(Shadow().hand);
  World world(Shadow().hand, Shadow().object, Config(GetParam()), q0, At(0, -0.5, 0));
  world.SetGravity(GraspGravity());
  for (int k = 0; k < 1000; ++k) {
    world.SetTorque(Compensation(world));
    ASSERT_EQ(world.Step(), StepStatus::kOk) << world.fault_message();
  }
  // Only rounding. A finger whose weight was off by one gram would sag by .01 rad.
  EXPECT_LT((world.state().q - q0).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(World, MergedAndPlainHandMoveAlike) {
  const JointVector q0 = GraspPosture(Shadow().hand);
  WorldConfig merged = Config(Stepper::kExact), plain = merged;
  plain.merge_universal = false;
  World a(Shadow().hand, Shadow().object, merged, q0, At(0, -0.5, 0));
  World b(Shadow().hand, Shadow().object, plain, q0, At(0, -0.5, 0));
  JointVector torque(Shadow().hand.num_joints());
  for (int i = 0; i < torque.size(); ++i) torque[i] = 0.02 * (i % 2 ? 1 : -1);
  for (World* world : {&a, &b}) {
    world->SetGravity(GraspGravity());
    world->SetTorque(torque);
    for (int k = 0; k < 300; ++k) ASSERT_EQ(world->Step(), StepStatus::kOk);
  }
  const double moved = (a.state().q - q0).cwiseAbs().maxCoeff();
  EXPECT_GT(moved, 0.1);
  // They differ in where the rotors of merged joints act while the parent moves, and by the inertia
  // of the links that were lumped: 2 % of the motion.
  EXPECT_LT((a.state().q - b.state().q).cwiseAbs().maxCoeff(), 0.02 * moved);
}

TEST_P(BothSteppers, BallOnThreeTipsWeighsWhatItWeighs) {
  World world(Cradle(0.025), Sphere(), Config(GetParam()), JointVector(0), At(0, 0, 0));
  world.SetGravity(Vector3d(0, 0, -kG));
  world.SetStandIn(false);
  for (const double mass : {0.08, 0.15}) {
    world.SetMass(mass);
    for (int k = 0; k < 3000; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk);
    ASSERT_EQ(world.state().contacts.size(), 3u);
    // At rest there is only rounding.
    EXPECT_LT((TotalContactForce(world) - Vector3d(0, 0, mass * kG)).norm(), 1e-6 * mass * kG);
    for (const ObjectContact& c : world.state().contacts) {
      EXPECT_NEAR((c.p_WC - world.state().p_WO).normalized().dot(c.normal_W), 1, 1e-6);
      EXPECT_GT(-c.force_W.dot(c.normal_W), 0) << "contacts push inward";
      // Static depth of a soft contact is f / k.
      EXPECT_NEAR(c.depth, -c.force_W.dot(c.normal_W) / 4000, 2e-5);
    }
  }
}

TEST(World, MeshSphereTouchesLikeASphere) {
  // 5 levels: 8192 triangles, edges of about 1.2 mm, each face within 1.5 deg and 8 um of the
  // sphere.
  World mesh(Cradle(0.025), MeshSphere(0.025, 5), {}, JointVector(0), At(0, 0, 0));
  World round(Cradle(0.025), Sphere(), {}, JointVector(0), At(0, 0, 0));
  for (World* world : {&mesh, &round}) {
    world->SetGravity(Vector3d(0, 0, -kG));
    world->SetStandIn(false);
    for (int k = 0; k < 3000; ++k) ASSERT_EQ(world->Step(), StepStatus::kOk);
  }
  ASSERT_EQ(mesh.state().contacts.size(), 3u);
  EXPECT_LT((mesh.state().p_WO - round.state().p_WO).norm(), 1e-4);
  EXPECT_NEAR(TotalContactForce(mesh).z(), 0.08 * kG, 1e-3 * 0.08 * kG);
  for (const ObjectContact& c : mesh.state().contacts)
    EXPECT_GT((c.p_WC - mesh.state().p_WO).normalized().dot(c.normal_W), std::cos(0.03));
}

TEST(World, MeshRestsOnAFlatPalm) {
  World world(Slab(), MeshSphere(0.025, 4), {}, JointVector(0), At(0, 0, 0.026));
  world.SetGravity(Vector3d(0, 0, -kG));
  world.SetStandIn(false);
  for (int k = 0; k < 2000; ++k) ASSERT_EQ(world.Step(), StepStatus::kOk) << world.fault_message();
  EXPECT_NEAR(world.state().p_WO.z(), 0.025, 1e-3);
}

TEST_P(BothSteppers, HeldBallIsBalancedByItsContacts) {
  Holding holding(Config(GetParam()));
  Vector3d mean = Vector3d::Zero();
  double drift = 0;
  for (int k = 0; k < 500; ++k) {
    holding.Tick();
    mean += TotalContactForce(*holding.world) / 500;
    drift = std::max(drift, holding.world->JointDrift());
  }
  EXPECT_EQ(holding.world->state().contacts.size(), 5u);
  const Vector3d weight = -0.08 * holding.world->gravity_W();
  // The ball settles by the springs of the fingers: the mean force is its weight within the 2 %
  // asked for.
  EXPECT_LT((mean - weight).norm(), 0.02 * weight.norm());
  EXPECT_LT(drift, 30e-6);  // the requirement
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
    JointVector torque(Shadow().hand.num_joints());
    for (int i = 0; i < torque.size(); ++i) torque[i] = 0.02 * (i % 2 ? 1 : -1);
    for (World* world : {&a, &b}) {
      world->SetGravity(GraspGravity());
      world->SetTorque(torque);
      for (int k = 0; k < 300; ++k) ASSERT_EQ(world->Step(), StepStatus::kOk);
    }
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

TEST_P(BothSteppers, HeldContactsDoNotCreep) {
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

TEST_P(BothSteppers, BallFallsWhenTheHandOpens) {
  Holding holding(Config(GetParam()));
  World& world = *holding.world;
  world.SetGravity(Vector3d(0, -kG, 0));  // palm down
  const double before = world.state().p_WO.y();
  for (int k = 0; k < 1000; ++k) {
    world.SetTorque(Compensation(world) - world.state().q);  // 1 N m/rad towards the flat hand
    ASSERT_EQ(world.Step(), StepStatus::kOk);
  }
  EXPECT_TRUE(world.state().contacts.empty());
  EXPECT_LT(world.state().p_WO.y() - before, -1) << "nothing else may hold the ball";
}

TEST_P(BothSteppers, EqualInputsGiveEqualBitsEvenInterleaved) {
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

TEST_P(BothSteppers, SurvivesFullEffortNoise) {
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

TEST_P(BothSteppers, AbsurdForcesInsideOdeAreFaults) {
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

TEST_P(BothSteppers, FaultsDoNotAddUp) {
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

TEST(StepperChoice, TakesTheExactStepWhereTheFastOneIsOff) {
  WorldConfig broken;
  broken.contact_solver.max_sweeps = 0;  // contact forces stay zero: through the object
  const StepperChoice choice = ChooseStepper(Shadow(), broken);
  EXPECT_EQ(choice.stepper, Stepper::kExact) << choice.reason;
  EXPECT_TRUE(choice.reason.starts_with("failed at load: closing the hand, ")) << choice.reason;
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

TEST_P(BothSteppers, StepAllocatesNothing) {
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
