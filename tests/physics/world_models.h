#pragma once

/// Small worlds with known answers, and the hand that holds the sphere, for tests of the world.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/common/hash.h"
#include "core/hand/kinematics.h"
#include "core/hand/scenario.h"
#include "core/world/world.h"
#include "tests/physics/grasp_posture.h"

namespace regrasp {

inline constexpr double kG = 9.81;
inline constexpr double kDt = 1e-3;

inline WorldConfig Config(Stepper stepper) {
  WorldConfig config;
  config.stepper = stepper;
  return config;
}

inline ObjectModel Sphere(double radius = 0.025, double mass = 0.08) {
  ObjectModel object;
  object.radius = object.bounding_radius = radius;
  object.mass = mass;
  object.I_OCom = 0.4 * mass * radius * radius * Matrix3d::Identity();
  return object;
}

inline ObjectModel Cube(double side = 0.04, double mass = 0.08) {
  ObjectModel object;
  object.kind = ObjectModel::Kind::kBox;
  object.half_extents = Vector3d::Constant(side / 2);
  object.bounding_radius = object.half_extents.norm();
  object.mass = mass;
  object.I_OCom = mass * side * side / 6 * Matrix3d::Identity();
  return object;
}

/// A sphere made of triangles: an octahedron, each face split `levels` times.
inline ObjectModel MeshSphere(double radius, int levels) {
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

inline Isometry3d At(double x, double y, double z) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(x, y, z);
  return X;
}

/// A palm that is a slab with its top at z = 0; no joints.
inline HandModel Slab() {
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

/// A palm with three fingertip-like spheres on which a ball can lie.
inline HandModel Cradle(double ball_radius) {
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

/// One link on one hinge about x, hanging along -z at q = 0.
inline HandModel Pendulum(double armature, double damping) {
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

inline const LoadedScenario& Shadow() {
  static const LoadedScenario scenario = LoadScenario("shadow", "sphere", ModelSearchPath());
  return scenario;
}

inline JointVector Compensation(const World& world) {
  KinematicsData data;
  ForwardKinematics(Shadow().hand, world.state().q, &data);
  return GravityTorque(Shadow().hand, data, world.gravity_W());
}

/// Presses all fingers on the object with 1 N towards its centre, springs of 3 N m/rad about
/// `rest`, which follows while `creep`.
inline JointVector Grasp(const World& world, JointVector* rest, bool creep) {
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

/// The hand closed on the sphere and the stand-in gone.
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

inline Vector3d TotalContactForce(const World& world) {
  Vector3d sum = Vector3d::Zero();
  for (const ObjectContact& contact : world.state().contacts) sum += contact.force_W;
  return sum;
}

inline std::uint64_t HashOf(const World& world) {
  StateHasher hasher;
  HashFields(world, &hasher);
  return hasher.Digest();
}

/// Instantiated in test_world.cc, for every file of this program.
class EachStepper : public testing::TestWithParam<Stepper> {};

}  // namespace regrasp
