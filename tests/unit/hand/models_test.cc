/// The models that come with the program.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/hand/kinematics.h"
#include "core/hand/mesh.h"
#include "core/hand/scenario.h"

namespace regrasp {
namespace {

LoadedScenario Shadow() { return LoadScenario("shadow", "", ModelSearchPath()); }

/// Distance between the segments p-p2 and q-q2 [m] (Ericson, Real-Time Collision Detection, 5.1.9).
double SegmentDistance(const Vector3d& p, const Vector3d& p2, const Vector3d& q,
                       const Vector3d& q2) {
  const Vector3d d1 = p2 - p, d2 = q2 - q, r = p - q;
  const double a = std::max(d1.squaredNorm(), 1e-30), e = std::max(d2.squaredNorm(), 1e-30);
  const double b = d1.dot(d2), c = d1.dot(r), f = d2.dot(r), denominator = a * e - b * b;
  double s = denominator > 1e-18 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = std::clamp((b * s + f) / e, 0.0, 1.0);
  s = std::clamp((b * t - c) / a, 0.0, 1.0);
  t = std::clamp((b * s + f) / e, 0.0, 1.0);
  return (p + s * d1 - q - t * d2).norm();
}

struct Clearance {
  double between_fingers = std::numeric_limits<double>::infinity();
  double to_point = std::numeric_limits<double>::infinity();  ///< of any capsule's surface
};

Clearance Measure(const HandModel& hand, const JointVector& q, const Vector3d& point_W) {
  std::vector<int> finger_of(hand.links.size(), -1);
  for (int f = 0; f < hand.num_fingers(); ++f)
    for (const int j : hand.fingers[f].joints) finger_of[hand.joints[j].child_link] = f;
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  struct Capsule {
    int finger;
    Vector3d a_W, b_W;
    double radius;
  };
  std::vector<Capsule> capsules;
  for (std::size_t l = 0; l < hand.links.size(); ++l)
    for (const Shape& s : hand.links[l].shapes)
      if (s.kind == Shape::Kind::kCapsule)
        capsules.push_back({finger_of[l], data.X_WL[l] * s.a_L, data.X_WL[l] * s.b_L, s.radius});
  Clearance clearance;
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    const Capsule& c = capsules[i];
    clearance.to_point =
        std::min(clearance.to_point, SegmentDistance(c.a_W, c.b_W, point_W, point_W) - c.radius);
    for (std::size_t k = i + 1; k < capsules.size(); ++k) {
      const Capsule& d = capsules[k];
      if (c.finger == d.finger) continue;
      clearance.between_fingers =
          std::min(clearance.between_fingers,
                   SegmentDistance(c.a_W, c.b_W, d.a_W, d.b_W) - c.radius - d.radius);
    }
  }
  return clearance;
}

TEST(ShadowHand, HasTheJointsLimitsAndEffortsOfTheHand) {
  const HandModel hand = Shadow().hand;
  ASSERT_EQ(hand.num_joints(), 22);
  ASSERT_EQ(hand.num_fingers(), 5);
  const char* const names[] = {"first", "middle", "ring", "little", "thumb"};
  const std::size_t joints[] = {4, 4, 4, 5, 5};
  double mass = 0;
  for (const Link& link : hand.links) mass += link.mass;
  // 300 palm, 4 x (8 + 30 + 17 + 13) fingers, 30 metacarpal, 92 thumb.
  EXPECT_NEAR(mass, 0.694, 1e-12);
  for (int f = 0; f < 5; ++f) {
    EXPECT_EQ(hand.fingers[f].name, names[f]);
    EXPECT_EQ(hand.fingers[f].joints.size(), joints[f]);
    EXPECT_TRUE(std::is_sorted(hand.fingers[f].joints.begin(), hand.fingers[f].joints.end()));
  }
  const auto joint = [&](const std::string& name) {
    return *std::find_if(hand.joints.begin(), hand.joints.end(),
                         [&](const Joint& j) { return j.name == name; });
  };
  EXPECT_NEAR(joint("THJ4").upper, 70 * M_PI / 180, 1e-9);  // the file carries ten digits
  EXPECT_NEAR(joint("LFJ5").upper, 45 * M_PI / 180, 1e-9);
  EXPECT_NEAR(joint("MFJ3").lower, -15 * M_PI / 180, 1e-9);
  EXPECT_EQ(joint("THJ5").effort, 5);
  EXPECT_EQ(joint("THJ1").effort, 1);
  EXPECT_EQ(joint("RFJ2").effort, 2);
  for (const Joint& j : hand.joints) {
    EXPECT_EQ(j.damping, 0.05) << j.name;
    EXPECT_EQ(j.armature, 2e-4) << j.name;
  }
}

TEST(ShadowHand, FingertipsEndWhereTheHandsDo) {
  const HandModel hand = Shadow().hand;
  for (const Finger& finger : hand.fingers) {
    const double length = finger.name == "thumb" ? 0.0275 : 0.026;
    EXPECT_NEAR(finger.p_LF.z() + finger.tip_radius, length, 1e-12) << finger.name;
  }
}

TEST(ShadowScenario, GravityIsThatOfTheTilt) {
  const Vector3d g = Shadow().scenario.gravity_W;
  EXPECT_NEAR(g.norm(), 9.81, 1e-5);  // six decimals in the file
  EXPECT_NEAR(std::atan2(g.z(), g.y()) * 180 / M_PI, 65, 1e-4);
}

TEST(ShadowScenario, PreshapeLeavesRoomForAnyClaimedObject) {
  const LoadedScenario loaded = Shadow();
  const Clearance c =
      Measure(loaded.hand, loaded.scenario.q_preshape, loaded.scenario.X_WO.translation());
  // 30 mm, the largest object's radius, and 5 mm for the spread of starts (3 deg, 2 mm).
  EXPECT_GT(c.to_point, 0.035);
  EXPECT_GT(c.between_fingers, 0.003);  // touching links double the cost of a step
}

// Each finger stops where it meets the ball; the smallest ball that is claimed has 45 mm.
TEST(ShadowScenario, FingersCloseOntoABallWithoutTouchingEachOther) {
  const LoadedScenario loaded = Shadow();
  const Scenario& s = loaded.scenario;
  const Vector3d centre = s.X_WO.translation();
  JointVector q = s.q_preshape;
  for (int k = 0; k <= 40; ++k) {
    KinematicsData at;
    ForwardKinematics(loaded.hand, q, &at);
    for (int f = 0; f < loaded.hand.num_fingers(); ++f) {
      const double gap =
          (FingertipCentre(loaded.hand, at, f) - centre).norm() - loaded.hand.fingers[f].tip_radius;
      if (gap < 0.0225) continue;
      for (int j : loaded.hand.fingers[f].joints)
        q[j] = s.q_preshape[j] + (s.q_closed[j] - s.q_preshape[j]) * (k / 40.0);
    }
    EXPECT_GT(Measure(loaded.hand, q, centre).between_fingers, 0.003) << k;
  }
  KinematicsData data;
  ForwardKinematics(loaded.hand, s.q_closed, &data);
  for (int f = 0; f < loaded.hand.num_fingers(); ++f)
    EXPECT_LT(
        (FingertipCentre(loaded.hand, data, f) - centre).norm() - loaded.hand.fingers[f].tip_radius,
        0.020)
        << loaded.hand.fingers[f].name;
}

TEST(Objects, AreAllReadAndPhysical) {
  const auto path = ModelSearchPath();
  const auto names = ListObjects(path);
  for (const char* expected :
       {"cube_40mm", "egg", "sphere", "sphere_40mm", "sphere_45mm", "sphere_60mm"})
    EXPECT_NE(std::find(names.begin(), names.end(), expected), names.end()) << expected;
  for (const std::string& name : names) {
    const ObjectModel object = LoadObject(name, path);
    EXPECT_EQ(object.mass, 0.08) << name;
    EXPECT_EQ(object.friction, 0.8) << name;
    // Nothing inside a ball of the bounding radius has a larger moment than a shell of that radius.
    EXPECT_LT(object.I_OCom.diagonal().maxCoeff(),
              2.0 / 3 * object.mass * object.bounding_radius * object.bounding_radius)
        << name;
    if (object.kind == ObjectModel::Kind::kSphere) {
      EXPECT_NEAR(object.I_OCom(0, 0), 0.4 * object.mass * object.radius * object.radius, 1e-10)
          << name;
    }
  }
  EXPECT_EQ(LoadObject("sphere", path).radius, 0.025);
  EXPECT_EQ(LoadObject("cube_40mm", path).half_extents, Vector3d(0.02, 0.02, 0.02));
}

TEST(Egg, IsAConvexSolidOfUniformDensity) {
  const ObjectModel egg = LoadObject("egg", ModelSearchPath());
  ASSERT_EQ(egg.kind, ObjectModel::Kind::kMesh);
  EXPECT_GE(egg.triangles.size(), 2500u);
  double volume = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const Eigen::Vector3i& t : egg.triangles) {
    const Vector3d &a = egg.vertices_O[t[0]], &b = egg.vertices_O[t[1]], &c = egg.vertices_O[t[2]];
    const double v = a.dot(b.cross(c)) / 6;
    const Vector3d sum = a + b + c;
    volume += v;
    first += v * sum / 4;
    second += v / 20 *
              (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
    // Convex: no vertex above the plane of any triangle. Vertices carry 1e-9 m.
    const Vector3d n = (b - a).cross(c - a).normalized();
    double highest = -1;
    for (const Vector3d& p : egg.vertices_O) highest = std::max(highest, n.dot(p - a));
    EXPECT_LT(highest, 1e-8);
  }
  EXPECT_LT((first / volume).norm(), 1e-7);
  const Matrix3d inertia = egg.mass / volume * (second.trace() * Matrix3d::Identity() - second);
  EXPECT_LT((inertia - egg.I_OCom).norm(),
            1e-3 * egg.I_OCom.norm());  // the file carries four or five digits
  Vector3d low = egg.vertices_O[0], high = low;
  for (const Vector3d& p : egg.vertices_O) low = low.cwiseMin(p), high = high.cwiseMax(p);
  EXPECT_NEAR(high.z() - low.z(), 0.050, 1e-4);
  EXPECT_NEAR(high.x() - low.x(), 0.040, 1e-3);
}

}  // namespace
}  // namespace regrasp
