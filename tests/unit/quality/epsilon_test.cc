#include "core/quality/epsilon.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/quality/grasps.h"
#include "tests/unit/quality/qhull_oracle.h"

namespace regrasp {
namespace {

using namespace test;

constexpr double kScale = 0.025;

void ExpectQhullAgrees(EpsilonSolver& solver, const Contacts& contacts, int edges) {
  std::vector<Wrench> points;
  AppendPrimitiveWrenches(contacts, kScale, edges, points);
  const QhullAnswer qhull = RunQhull(points);
  if (!qhull.ok) return;
  // The promised exactness; the two agree to 1e-15 where points are in general position.
  EXPECT_NEAR(solver.Compute(contacts, kScale, edges), std::max(0.0, qhull.least_offset), 1e-9);
  EXPECT_TRUE(solver.exact());
  if (qhull.volume < 1e-6) return;
  EXPECT_NEAR(WrenchHullVolume(contacts, kScale, edges), qhull.volume, 1e-6 * qhull.volume);
}

TEST(Epsilon, AgreesWithQhullOnRandomGrasps) {
  EpsilonSolver solver;
  RandomStream random(1, 0);
  int closed = 0;
  for (int i = 0; i < 150; ++i) {
    const Contacts contacts = Random(random, 3 + i % 4);
    ExpectQhullAgrees(solver, contacts, i % 3 ? 8 : 5);
    closed += solver.result() > 0;
  }
  EXPECT_GT(closed, 75);
  EXPECT_LT(closed, 150);
}

TEST(Epsilon, AgreesWithQhullOnSymmetricAndRepeatedContacts) {
  EpsilonSolver solver;
  for (int n = 3; n <= 6; ++n) ExpectQhullAgrees(solver, Ring(n, kScale, 0.8), 8);
  ExpectQhullAgrees(solver, Tetrahedron(kScale, 0.5), 8);
  ExpectQhullAgrees(solver, Tetrahedron(kScale, 0.5), 12);
  ExpectQhullAgrees(
      solver,
      OnSphere({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, kScale, 0.6),
      8);
  Contacts repeated = Ring(3, kScale, 0.8);
  repeated.insert(repeated.end(), repeated.begin(), repeated.begin() + 2);
  ExpectQhullAgrees(solver, repeated, 8);
  EXPECT_NEAR(solver.result(), solver.Compute(Ring(3, kScale, 0.8), kScale, 8), 1e-12);
}

TEST(Epsilon, SurvivesNearlyDegenerateGrasps) {
  // Contacts that miss a symmetric arrangement by less and less, down to the hull's own tolerance
  // (1e-10), where building it again with a coarser one must help. The result may move by what the
  // points do.
  EpsilonSolver solver;
  RandomStream random(2, 0);
  const std::vector<Contacts> families = {
      Ring(4, kScale, 0.8), Ring(5, kScale, 0.8), Tetrahedron(kScale, 0.8),
      OnSphere({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 0, 0}, {0, 1, 0}}, kScale, 0.8)};
  for (const Contacts& family : families) {
    const double expected = solver.Compute(family, kScale, 8);
    ASSERT_GT(expected, 0.01);
    for (double noise = 1e-7; noise > 1e-14; noise *= 0.3) {
      for (int i = 0; i < 4; ++i) {
        Contacts contacts = family;
        for (GraspContact& c : contacts) {
          c.position += kScale * noise * random.Normal3();
          c.inward_normal = (c.inward_normal + noise * random.Normal3()).normalized();
        }
        EXPECT_NEAR(solver.Compute(contacts, kScale, 8), expected, 10 * noise + 1e-6);
        EXPECT_TRUE(solver.exact());
        EXPECT_NO_THROW(WrenchHullVolume(contacts, kScale, 8));
      }
    }
  }
}

TEST(Epsilon, OfTheFrictionlessCubeIsClosedForm) {
  EXPECT_NEAR(EpsilonSolver().Compute(Cube(kScale), kScale, 3), 1 / std::sqrt(3), 1e-12);
  EXPECT_NEAR(WrenchHullVolume(Cube(kScale), kScale, 3), 64.0 * 8 / 720, 1e-12);
}

TEST(Epsilon, IsZeroWithoutForceClosure) {
  EpsilonSolver solver;
  const std::vector<Contacts> grasps = {
      {},
      Ring(1, kScale, 0.8),
      OnSphere({{1, 0, 0}, {-1, 0, 0}}, kScale, 0.8),                         // torsion
      OnSphere({{0, 0, -1}, {1, 0, -1}, {-1, 1, -1}}, kScale, 0.3),           // all from below
      OnSphere({{1, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {-1, 0, 0}}, kScale, 0.8),  // on one line
      Ring(5, kScale, 0.0)};                                                  // no friction
  for (const Contacts& contacts : grasps) EXPECT_EQ(solver.Compute(contacts, kScale, 8), 0.0);
  EXPECT_EQ(WrenchHullVolume(grasps[2], kScale, 8), 0.0);
}

TEST(Epsilon, IsPositiveExactlyWhereQhullHasTheOriginInside) {
  EpsilonSolver solver;
  RandomStream random(3, 0);
  int inside = 0, outside = 0;
  for (int i = 0; i < 200; ++i) {
    const Contacts contacts = Random(random, 3 + i % 2);
    std::vector<Wrench> points;
    AppendPrimitiveWrenches(contacts, kScale, 8, points);
    const QhullAnswer qhull = RunQhull(points);
    if (!qhull.ok) continue;
    const bool holds = qhull.least_offset > 1e-9;
    EXPECT_EQ(solver.Compute(contacts, kScale, 8) > 0, holds) << i;
    ++(holds ? inside : outside);
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(outside, 20);
}

TEST(Epsilon, DoesNotDependOnTheUnitOfLengthAndGrowsWithContacts) {
  EpsilonSolver solver;
  RandomStream random(4, 0);
  for (int i = 0; i < 50; ++i) {
    Contacts contacts = Random(random, 4);
    const double epsilon = solver.Compute(contacts, kScale, 8);
    Contacts in_mm = contacts;
    for (GraspContact& c : in_mm) c.position *= 1000;
    EXPECT_NEAR(solver.Compute(in_mm, 1000 * kScale, 8), epsilon, 1e-9);
    contacts.push_back(Random(random, 1)[0]);
    EXPECT_GE(solver.Compute(contacts, kScale, 8), epsilon - 1e-9);  // a larger hull
  }
}

TEST(Epsilon, DoesNotDependOnHowTheWorkIsDivided) {
  EpsilonSolver at_once, in_steps;
  RandomStream random(5, 0);
  for (int i = 0; i < 50; ++i) {
    const Contacts contacts = Random(random, 5);
    const double epsilon = at_once.Compute(contacts, kScale, 8);
    const int budget = 1 + static_cast<int>(400 * random.Uniform());
    in_steps.Begin(contacts, kScale, 8);
    double bound = in_steps.lower_bound();
    while (!in_steps.Step(budget)) {
      EXPECT_GE(in_steps.lower_bound(), bound);
      EXPECT_LE(in_steps.lower_bound(), epsilon);
      bound = in_steps.lower_bound();
    }
    EXPECT_EQ(in_steps.result(), epsilon);  // the same bits
  }
}

TEST(Epsilon, BeginDropsTheComputationUnderWay) {
  EpsilonSolver solver;
  EXPECT_TRUE(solver.done());
  EXPECT_EQ(solver.result(), 0.0);
  const Contacts five = Ring(5, kScale, 0.8), four = Tetrahedron(kScale, 0.5);
  const double expected = EpsilonSolver().Compute(four, kScale, 8);
  solver.Begin(five, kScale, 8);
  EXPECT_FALSE(solver.Step(1));
  solver.Begin(four, kScale, 8);
  while (!solver.Step(1)) {
  }
  EXPECT_EQ(solver.result(), expected);
}

TEST(WrenchHullVolume, RefusesMoreWrenchesThanItHasRoomFor) {
  EXPECT_THROW(WrenchHullVolume(Ring(8, kScale, 0.8), kScale, 64), std::length_error);
}

}  // namespace
}  // namespace regrasp
