/// Objects of several pieces: their surface against formulas, and in the hand.

#include <unistd.h>

#include <cmath>
#include <fstream>

#include "core/hand/kinematics.h"
#include "core/hand/object_loader.h"
#include "core/world/start_overlap.h"
#include "core/world/true_surface.h"
#include "tests/physics/session_run.h"

namespace regrasp {
namespace {

struct Ball {
  Vector3d centre;
  double radius;
};

/// Balls as <collision> elements of one homogeneous body of 80 g.
ObjectModel Balls(const std::vector<Ball>& balls) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("regrasp_pieces_" + std::to_string(::getpid()) + ".urdf");
  std::ofstream out(file);
  out << R"(<robot name="p"><link name="o"><inertial><mass value="0.08"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>)";
  for (const Ball& b : balls)
    out << "<collision><origin xyz=\"" << b.centre.x() << ' ' << b.centre.y() << ' ' << b.centre.z()
        << "\"/><geometry><sphere radius=\"" << b.radius << "\"/></geometry></collision>";
  out << "</link></robot>";
  out.close();
  LoadOptions options;
  options.inertia_from_shape = true;
  const ObjectModel object = LoadObjectUrdf(file, options);
  std::filesystem::remove(file);
  return object;
}

/// How far the links reach into the object, by its distance alone.
StartOverlap OverlapByDistance(const HandModel& hand, const std::vector<Isometry3d>& X_WL,
                               const ObjectModel& object, const Isometry3d& X_WO) {
  const TrueSurface surface(object);
  StartOverlap deepest;
  for (std::size_t l = 0; l < hand.links.size(); ++l)
    for (const Shape& shape : hand.links[l].shapes)
      for (int k = 0; k <= 8 && shape.kind == Shape::Kind::kCapsule; ++k) {
        const Vector3d p_L = shape.b_L + k / 8.0 * (shape.a_L - shape.b_L);
        const double depth = shape.radius - surface.At(X_WO.inverse() * (X_WL[l] * p_L)).distance;
        if (depth > deepest.depth) deepest = {static_cast<int>(l), depth};
      }
  return deepest;
}

TEST(Pieces, AStartInsideTheHandIsFoundAsDeepAsItIs) {
  const LoadedScenario loaded = LoadScenario("shadow", "zoo_peanut_lying", ModelSearchPath());
  HandModel hand = loaded.hand;
  for (Link& link : hand.links)
    std::erase_if(link.shapes, [](const Shape& s) { return s.kind == Shape::Kind::kBox; });
  KinematicsData data;
  ForwardKinematics(hand, loaded.scenario.q_preshape, &data);
  const std::vector<Isometry3d> X_WL(
      data.X_WL.begin(), data.X_WL.begin() + static_cast<std::ptrdiff_t>(hand.links.size()));
  int inside = 0;
  constexpr int kPlaces = 40;
  for (int i = 0; i < kPlaces; ++i) {  // nearer and farther from one link after the other
    Isometry3d X_WO = loaded.scenario.X_WO;
    X_WO.translation() = X_WL[static_cast<std::size_t>(7 * i) % X_WL.size()].translation() +
                         (0.01 + 0.004 * i) * Vector3d(std::cos(i), std::sin(i), 0.5);
    const StartOverlap found = DeepestOverlap(hand, X_WL, loaded.object, X_WO);
    const StartOverlap expected = OverlapByDistance(hand, X_WL, loaded.object, X_WO);
    EXPECT_EQ(found.link, expected.link) << i;
    EXPECT_NEAR(found.depth, expected.depth, 1e-12) << i;
    inside += expected.link >= 0;
  }
  EXPECT_GT(inside, 5);
  EXPECT_LT(inside, kPlaces);
}

TEST(Pieces, DistanceIsThatOfTheNearestPiece) {
  const std::vector<Ball> balls = {{Vector3d(-0.012, 0, 0), 0.022}, {Vector3d(0.012, 0, 0), 0.022}};
  const ObjectModel object = Balls(balls);
  ASSERT_EQ(object.kind, ObjectModel::Kind::kMesh);
  const TrueSurface surface(object);
  constexpr double kFacets = 4e-5;  // facets, and the centre of mass found by columns
  // The most that a facet's normal is off the direction of its corners. Where a corner is nearest,
  // the place is seen from there between the normals of the facets that meet, so within as much
  // again.
  double off = 0;
  for (const Eigen::Vector3i& t : object.triangles) {
    const Vector3d &a = object.vertices_O[t[0]], &b = object.vertices_O[t[1]];
    const Vector3d normal = (b - a).cross(object.vertices_O[t[2]] - a).normalized();
    double nearer = 0;
    for (const Ball& ball : balls)
      nearer = std::max(nearer, normal.dot((a - ball.centre).normalized()));
    off = std::max(off, std::acos(nearer));
  }
  ASSERT_LT(off, 0.1);
  int outside = 0, in_one = 0, in_both = 0;
  for (int i = -9; i <= 9; ++i)
    for (int j = -6; j <= 6; ++j)
      for (int k = -6; k <= 6; ++k) {
        const Vector3d p = 0.005 * Vector3d(i, j, k) + Vector3d(0.0007, 0.0003, 0.0011);
        double nearest = 1;
        int inside = 0;
        Vector3d normal = Vector3d::Zero();
        for (const Ball& b : balls) {
          const double d = (p - b.centre).norm() - b.radius;
          inside += d < 0;
          if (d < nearest) normal = (p - b.centre).normalized();
          nearest = std::min(nearest, d);
        }
        if (std::abs(nearest) < 1e-4) continue;
        const TrueSurface::Nearest found = surface.At(p);
        // Whichever surface is near: the sign is that of the body they make together.
        EXPECT_EQ(found.distance<0, inside> 0) << p.transpose();
        outside += inside == 0;
        in_one += inside == 1;
        in_both += inside == 2;
        if (inside > 0) continue;
        EXPECT_NEAR(found.distance, nearest, kFacets) << p.transpose();
        // In the middle plane both balls are as near.
        if (std::abs(p.x()) > 2e-3) {
          EXPECT_GT(found.normal_O.dot(normal), std::cos(2 * off));
        }
      }
  EXPECT_GT(outside, 100);
  EXPECT_GT(in_one, 100);
  EXPECT_GT(in_both, 20);
}

/// Grasps and holds for a second; what every contact must be is checked by `contact`.
void ExpectHonestHold(const ObjectModel& object,
                      const std::function<void(const ObjectContact&, const Vector3d&)>& contact) {
  SessionConfig config = ShadowConfig(1);
  config.model.object = object;
  config.parameters = DefaultParameters(config.model);
  SessionRun run(config);
  ASSERT_TRUE(run.Grasp());
  ASSERT_EQ(run.Job().state, JobState::kDone);
  const Vector3d p0 = run.session.truth().p_WO;
  Vector3d force = Vector3d::Zero();
  constexpr int kTicks = 1000;
  for (int k = 0; k < kTicks; ++k) {
    run.Tick();
    ASSERT_FALSE(run.session.world().stand_in());
    for (const ObjectContact& c : run.session.truth().contacts) {
      force += c.force_W;
      EXPECT_GE(c.finger, 0);
      contact(c, run.session.truth().p_WO);
    }
  }
  EXPECT_EQ(run.session.state(), SessionState::kHolding);
  const Vector3d weight = run.session.world().mass_kg() * run.session.world().gravity_W();
  EXPECT_LT((force / kTicks + weight).norm(), 0.02 * weight.norm());
  EXPECT_LT((run.session.truth().p_WO - p0).norm(), 2e-3);
}

TEST(Pieces, ABallOfFacetsIsHeldLikeABall) {
  // The second ball lies within the first: the same body, by the way of several pieces.
  const ObjectModel object = Balls({{Vector3d::Zero(), 0.025}, {Vector3d(0.001, 0, 0), 0.02}});
  ASSERT_EQ(object.kind, ObjectModel::Kind::kMesh);
  EXPECT_NEAR(object.I_OCom(0, 0), 0.4 * 0.08 * 0.025 * 0.025, 5e-3 * 2e-5);
  ExpectHonestHold(object, [](const ObjectContact& c, const Vector3d& p_WO) {
    const Vector3d outwards = (c.p_WC - p_WO).normalized();
    EXPECT_GT(std::abs(c.normal_W.dot(outwards)), std::cos(0.08));
    EXPECT_NEAR((c.p_WC - p_WO).norm(), 0.025, 5e-4);
  });
}

TEST(Pieces, TwoBallsInOneAreHeld) {
  ExpectHonestHold(Balls({{Vector3d(-0.004, 0, 0), 0.023}, {Vector3d(0.004, 0, 0), 0.023}}),
                   [](const ObjectContact&, const Vector3d&) {});
}

}  // namespace
}  // namespace regrasp
