/// Hulls of wrenches that lie in common planes: the measures never fail, and agree with qhull.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "core/quality/epsilon.h"
#include "core/quality/evaluate_json.h"
#include "tests/unit/quality/grasps.h"
#include "tests/unit/quality/qhull_oracle.h"

namespace regrasp {
namespace {

using namespace test;

/// Against qhull, to what the coarsest tolerance may differ by.
void ExpectAsQhull(const Contacts& contacts, double scale, int edges) {
  std::vector<Wrench> points;
  AppendPrimitiveWrenches(contacts, scale, edges, points);
  double epsilon = 0, volume = 0;
  EpsilonSolver solver;
  ASSERT_NO_THROW(volume = WrenchHullVolume(contacts, scale, edges));
  ASSERT_NO_THROW(epsilon = solver.Compute(contacts, scale, edges));
  EXPECT_TRUE(solver.exact());
  const QhullAnswer oracle = RunQhull(points);
  if (!oracle.ok) {  // qhull refuses flat sets
    EXPECT_LT(volume, 1e-6);
    return;
  }
  EXPECT_NEAR(epsilon, std::max(0.0, oracle.least_offset), 1e-6);
  EXPECT_NEAR(volume, oracle.volume, 1e-5 * oracle.volume + 1e-9);
}

TEST(DegenerateHulls, RingsOfFewEdgesAgreeWithQhull) {
  for (const double scale : {0.025, 0.1, 1.025})
    for (int n = 2; n <= 6; ++n)
      for (const int edges : {3, 4, 5, 6}) {
        SCOPED_TRACE(std::to_string(n) + " contacts, " + std::to_string(edges) + " edges, scale " +
                     std::to_string(scale));
        ExpectAsQhull(Ring(n, 0.025, 0.8), scale, edges);
      }
}

TEST(DegenerateHulls, RoundedNumbersAsPeopleWriteThem) {
  // Components rounded to three digits: nearly coplanar, by every amount.
  for (int digits = 2; digits <= 6; ++digits)
    for (int n = 3; n <= 5; ++n) {
      SCOPED_TRACE(std::to_string(n) + " contacts, " + std::to_string(digits) + " digits");
      Contacts contacts = Ring(n, 0.025, 0.8);
      const double unit = std::pow(10, -digits);
      for (GraspContact& c : contacts) {
        for (double& x : c.position) x = std::round(x / unit / 0.1) * unit * 0.1;
        for (double& x : c.inward_normal) x = std::round(x / unit) * unit;
        c.inward_normal.normalize();
      }
      ExpectAsQhull(contacts, 1.025, 3);
    }
}

TEST(DegenerateHulls, RepeatedAndOpposedContacts) {
  Contacts twice = Tetrahedron(0.025, 0.5);
  const Contacts once = twice;
  twice.insert(twice.end(), once.begin(), once.end());
  ExpectAsQhull(twice, 0.025, 3);
  EXPECT_NEAR(EpsilonSolver().Compute(twice, 0.025, 3), EpsilonSolver().Compute(once, 0.025, 3),
              1e-6);
  ExpectAsQhull(Ring(2, 0.025, 0.8), 0.025, 3);  // on one line
  Contacts flat = Ring(3, 0.025, 0.0);           // without friction: no volume
  EXPECT_EQ(EpsilonSolver().Compute(flat, 0.025, 3), 0.0);
}

TEST(DegenerateHulls, AThousandEdgesApproachTheRoundCone) {
  const Contacts contacts = Ring(3, 0.025, 0.8);
  const double coarse = EpsilonSolver().Compute(contacts, 0.025, 64);
  const double fine = EpsilonSolver().Compute(contacts, 0.025, 1000);
  EXPECT_GE(fine, coarse - 1e-6);
  EXPECT_NEAR(fine, coarse, 5e-3);  // a pyramid of 64 edges loses 1 - cos(pi / 64) = 0.12 %
}

TEST(DegenerateHulls, ThreeContactsWithThreeEdgesAreAnswered) {
  const auto answer = nlohmann::json::parse(EvaluateJson(
      R"({"contacts": [{"position_m": [0.025, 0, 0], "normal": [-1, 0, 0], "mu": 0.8},
      {"position_m": [-0.0125, 0.02165, 0], "normal": [0.5, -0.866, 0], "mu": 0.8},
      {"position_m": [-0.0125, -0.02165, 0], "normal": [0.5, 0.866, 0], "mu": 0.8}],
      "torque_scale_m": 1.025, "cone_edges": 3, "weight_n": [0, 0, -0.785]})"));
  EXPECT_GE(answer["epsilon"], 0.0);
  EXPECT_GE(answer["volume"], 0.0);
}

}  // namespace
}  // namespace regrasp
