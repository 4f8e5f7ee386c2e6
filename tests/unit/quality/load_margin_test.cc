#include "core/quality/load_margin.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/quality/grasps.h"

namespace regrasp {
namespace {

using namespace test;

constexpr double kScale = 0.025;
constexpr double kNone = 1e30;
const Vector3d kWeight(0, 0, -0.785);
// What load_margin.h promises for the grasps of this file.
const double kTolerance = 1e-5 * kWeight.norm();
const Vector3d kBelow(0, 0, -1);  // most contacts under the object: held, but no force closure

/// Least |A x - b| over x >= 0 [Lawson, Hanson 1974].
double DistanceToCone(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(A.cols());
  std::vector<int> active;
  for (int pass = 0; pass < 500; ++pass) {
    const Eigen::VectorXd w = A.transpose() * (b - A * x);
    int enter = -1;
    double best = 1e-11;
    for (int i = 0; i < A.cols(); ++i) {
      if (w(i) <= best || std::find(active.begin(), active.end(), i) != active.end()) continue;
      best = w(i);
      enter = i;
    }
    if (enter < 0) break;
    active.push_back(enter);
    for (;;) {
      Eigen::MatrixXd B(A.rows(), active.size());
      for (std::size_t i = 0; i < active.size(); ++i) B.col(i) = A.col(active[i]);
      const Eigen::VectorXd s = B.colPivHouseholderQr().solve(b);
      double step = 1.0;
      for (std::size_t i = 0; i < active.size(); ++i)
        if (s(i) <= 0) step = std::min(step, x(active[i]) / (x(active[i]) - s(i)));
      for (std::size_t i = 0; i < active.size(); ++i) x(active[i]) += step * (s(i) - x(active[i]));
      if (step == 1.0) break;
      std::erase_if(active, [&](int i) {
        if (x(i) > 1e-13) return false;
        x(i) = 0;
        return true;
      });
    }
  }
  return (b - A * x).norm();
}

/// The margin with polyhedral cones of `edges` edges inside (or around) the round ones, by
/// bisection; up to 20 weights. Shares nothing with the library's method.
double PolyhedralMargin(const Contacts& contacts, const Vector3d& weight, double cap, int edges,
                        bool around) {
  const int n = static_cast<int>(contacts.size());
  const int caps = cap < kNone ? n : 0;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6 + caps, n * edges + caps);
  for (int i = 0; i < n; ++i) {
    const GraspContact& c = contacts[i];
    const TangentBasis b = ContactTangents(c.inward_normal);
    const double mu = around ? c.mu / std::cos(M_PI / edges) : c.mu;
    for (int j = 0; j < edges; ++j) {
      const double a = 2 * M_PI * j / edges;
      const Vector3d f = c.inward_normal + mu * (std::cos(a) * b.t1 + std::sin(a) * b.t2);
      A.col(i * edges + j).head<6>() << f, c.position.cross(f) / kScale;
      if (caps) A(6 + i, i * edges + j) = 1;
    }
    if (caps) A(6 + i, n * edges + i) = 1;
  }
  Eigen::VectorXd b = Eigen::VectorXd::Zero(6 + caps);
  b.head<3>() = -weight;
  if (caps) b.tail(caps).setConstant(cap);
  const auto balanced = [&](const Eigen::VectorXd& load) { return DistanceToCone(A, load) < 1e-8; };
  if (!balanced(b)) return 0.0;
  double margin = 20 * weight.norm();
  for (int d = 0; d < 12; ++d) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(6 + caps);
    unit(d / 2) = d % 2 ? 1.0 : -1.0;
    if (balanced(b + margin * unit)) continue;
    double least = 0.0;
    while (margin - least > 1e-7 * weight.norm()) {
      const double middle = 0.5 * (least + margin);
      (balanced(b + middle * unit) ? least : margin) = middle;
    }
  }
  return margin;
}

void ExpectInBracket(const Contacts& contacts, const Vector3d& weight, double cap) {
  const double margin = std::min(LoadMargin(contacts, weight, kScale, cap), 20 * weight.norm());
  EXPECT_GE(margin, PolyhedralMargin(contacts, weight, cap, 48, false) - kTolerance);
  EXPECT_LE(margin, PolyhedralMargin(contacts, weight, cap, 48, true) + kTolerance);
}

TEST(LoadMargin, LiesBetweenInscribedAndCircumscribedPolyhedralCones) {
  RandomStream random(1, 0);
  int positive = 0;
  for (int i = 0; i < 120; ++i) {
    const Contacts contacts = Random(random, 3 + i % 3, kBelow);
    ExpectInBracket(contacts, kWeight, kNone);
    const double margin = LoadMargin(contacts, kWeight, kScale);
    positive += margin > 0 && std::isfinite(margin);
  }
  EXPECT_GT(positive, 25);  // the claim is not about zeros and infinities
}

TEST(LoadMargin, LiesBetweenPolyhedralConesWithForceCapsAndAnyGravity) {
  RandomStream random(2, 0);
  int positive = 0;
  for (int i = 0; i < 60; ++i) {
    const Contacts contacts = Random(random, 3 + i % 3);
    const Vector3d weight = 0.785 * random.Normal3().normalized();
    ExpectInBracket(contacts, weight, i % 2 ? 4.0 : 1.0);
    positive += LoadMargin(contacts, weight, kScale, 4.0) > 0;
  }
  EXPECT_GT(positive, 15);
}

// Three contacts on a horizontal plane through the centre, normals up, at radius a: N = W / 3 each.
// Lifting takes W; sliding mu W; turning about z mu W a; tipping over the nearest side of the
// triangle W a / 2.
Contacts Table(double a, double mu) {
  Contacts contacts = Ring(3, a, mu);
  for (GraspContact& c : contacts) c.inward_normal = Vector3d::UnitZ();
  return contacts;
}

TEST(LoadMargin, OfATableIsItsLeastOfLiftingSlidingTurningTipping) {
  const double W = kWeight.norm();
  EXPECT_NEAR(LoadMargin(Table(kScale, 0.3), kWeight, kScale), 0.3 * W, kTolerance);
  EXPECT_NEAR(LoadMargin(Table(kScale, 0.8), kWeight, kScale), 0.5 * W, kTolerance);
  EXPECT_NEAR(LoadMargin(Table(4 * kScale, 1.5), kWeight, kScale), 1.0 * W, kTolerance);
  EXPECT_NEAR(LoadMargin(Table(0.5 * kScale, 0.3), kWeight, kScale), 0.15 * W, kTolerance);
}

TEST(LoadMargin, OfATableCappedAtItsLoadAllowsNoMoreWeight) {
  const double W = kWeight.norm();
  // Pressing down by delta needs W + delta <= 3 caps; tipping loads one contact with more than W
  // / 3.
  EXPECT_NEAR(LoadMargin(Table(4 * kScale, 1.5), kWeight, kScale, 0.4 * W), 0.2 * W, kTolerance);
  EXPECT_EQ(LoadMargin(Table(4 * kScale, 1.5), kWeight, kScale, 0.33 * W), 0.0);
}

TEST(LoadMargin, IsZeroForTwoContacts) {
  // Nothing resists torsion about the line through them.
  EXPECT_EQ(LoadMargin(OnSphere({{1, 0, 0}, {-1, 0, 0}}, kScale, 0.8), kWeight, kScale), 0.0);
  EXPECT_EQ(LoadMargin(OnSphere({{1, 0, 0}, {-1, 0, 0}}, kScale, 0.8), kWeight, kScale, 4.0), 0.0);
  EXPECT_EQ(LoadMargin(OnSphere({{0, 0, -1}}, kScale, 0.8), kWeight, kScale), 0.0);
  EXPECT_EQ(LoadMargin({}, kWeight, kScale), 0.0);
}

TEST(LoadMargin, IsZeroWhereTheWeightSlipsThrough) {
  EXPECT_EQ(
      LoadMargin(OnSphere({{1, 0, 1}, {-1, 1, 1}, {-1, -1, 1}}, kScale, 0.5), kWeight, kScale),
      0.0);
}

TEST(LoadMargin, IsUnboundedForForceClosureWithoutACap) {
  EXPECT_TRUE(std::isinf(LoadMargin(Ring(3, kScale, 0.5), kWeight, kScale)));
  EXPECT_TRUE(std::isinf(LoadMargin(Tetrahedron(kScale, 0.5), kWeight, kScale)));
  // With a cap it is not; and more force never hurts.
  double last = 0.0;
  for (const double cap : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    const double margin = LoadMargin(Tetrahedron(kScale, 0.5), kWeight, kScale, cap);
    EXPECT_GT(margin, last);
    EXPECT_LT(margin, 4 * cap);
    last = margin;
  }
}

TEST(LoadMargin, WithAGenerousCapIsThatWithout) {
  RandomStream random(3, 0);
  for (int i = 0; i < 100; ++i) {
    const Contacts contacts = Random(random, 3 + i % 3, kBelow);
    const double margin = LoadMargin(contacts, kWeight, kScale);
    if (!(margin < kWeight.norm())) continue;  // a larger one may take any force
    EXPECT_NEAR(LoadMargin(contacts, kWeight, kScale, 1e4), margin, kTolerance);
  }
}

TEST(LoadMargin, ScalesWithTheWeightAndTheCap) {
  RandomStream random(4, 0);
  for (int i = 0; i < 100; ++i) {
    const Contacts contacts = Random(random, 4, kBelow);
    const double margin = LoadMargin(contacts, kWeight, kScale, 4.0);
    EXPECT_NEAR(LoadMargin(contacts, 7 * kWeight, kScale, 28.0), 7 * margin, 7 * kTolerance);
  }
}

TEST(LoadMargin, DoesNotDependOnTheUnitOfLengthNorOnQuarterTurns) {
  RandomStream random(5, 0);
  const Matrix3d turn = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix() *
                        Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
  for (int i = 0; i < 100; ++i) {
    const Contacts contacts = Random(random, 4, kBelow);
    const double margin = LoadMargin(contacts, kWeight, kScale, 4.0);
    Contacts in_mm = contacts;
    for (GraspContact& c : in_mm) c.position *= 1000;
    EXPECT_NEAR(LoadMargin(in_mm, kWeight, 1000 * kScale, 4.0), margin, kTolerance);
    // Quarter turns map the 12 loads to themselves; other rotations do not.
    EXPECT_NEAR(LoadMargin(Rotated(contacts, turn), turn * kWeight, kScale, 4.0), margin,
                kTolerance);
  }
}

TEST(LoadMargin, NeverFallsWhenAContactIsAdded) {
  RandomStream random(6, 0);
  for (int i = 0; i < 200; ++i) {
    Contacts contacts = Random(random, 3, i % 2 ? kBelow : Vector3d::Zero());
    double last = LoadMargin(contacts, kWeight, kScale, 4.0);
    while (contacts.size() < 10) {  // beyond kMaxFingers too
      contacts.push_back(Random(random, 1)[0]);
      const double margin = LoadMargin(contacts, kWeight, kScale, 4.0);
      EXPECT_GE(margin, last - kTolerance);
      last = margin;
    }
  }
}

// Without contacts the whole weight is missing; contacts that nearly hold it miss less than those
// that hold it not at all; where it is held the sign changes nothing.
TEST(SignedLoadMargin, TellsHowMuchIsMissing) {
  const Vector3d weight(0, 0, -0.8);
  EXPECT_NEAR(SignedLoadMargin({}, weight, 0.025, 4.0), -0.8, 1e-4);
  const auto Pinch = [](double mu) {
    Grasp grasp;
    for (const double side : {-1.0, 1.0})
      for (const double shift : {-0.004, 0.004})
        grasp.push_back({Vector3d(0.02 * side, shift, 0), Vector3d(-side, 0, 0), mu});
    return grasp;
  };
  const Grasp smooth = Pinch(0.01), rougher = Pinch(0.03), rough = Pinch(0.5);
  const auto Signed = [&](const Grasp& grasp) {
    return SignedLoadMargin({grasp.data(), grasp.size()}, weight, 0.025, 4.0);
  };
  EXPECT_LT(Signed(smooth), Signed(rougher));
  EXPECT_NEAR(Signed(smooth), -(0.8 - 4 * 4.0 * 0.01), 1e-3);  // friction at the force cap
  EXPECT_LT(Signed(rougher), 0);
  EXPECT_GT(Signed(rough), 0);
  EXPECT_EQ(Signed(rough), LoadMargin({rough.data(), rough.size()}, weight, 0.025, 4.0));
}

}  // namespace
}  // namespace regrasp
