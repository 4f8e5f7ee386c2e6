#include "core/quality/stability.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "tests/unit/quality/grasps.h"

namespace regrasp {
namespace {

using namespace test;

// For contacts at distance torque_scale whose positions sum to zero, G Gᵀ is block diagonal: n I
// and n I - sum r rᵀ. Closed forms are exact but for the eigenvalue solver's rounding.
constexpr double kRounding = 1e-13;
constexpr double kScale = 0.025;

TEST(Tangents, FollowTheInterface) {
  const TangentBasis z = ContactTangents(Vector3d::UnitZ());
  EXPECT_TRUE(z.t1.isApprox(Vector3d::UnitY()));  // z x x
  EXPECT_TRUE(z.t2.isApprox(-Vector3d::UnitX()));
  const TangentBasis x = ContactTangents(-Vector3d::UnitX());
  EXPECT_TRUE(x.t1.isApprox(Vector3d::UnitY()));  // -x x z
  RandomStream random(1, 0);
  for (int i = 0; i < 50; ++i) {
    const Vector3d n = random.Normal3().normalized();
    const TangentBasis b = ContactTangents(n);
    Matrix3d R;
    R << b.t1, b.t2, n;
    EXPECT_TRUE(R.isUnitary(1e-14));
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);  // t2 = n x t1
    EXPECT_NEAR(b.t1.x(), 0.0, 1e-15);         // t1 = n x e_x
  }
}

TEST(SingularMeasures, OfARegularTriangle) {
  const SingularMeasures m = ComputeSingularMeasures(Ring(3, kScale, 0.8), kScale);
  EXPECT_NEAR(m.min_singular_value, std::sqrt(1.5), kRounding);
  EXPECT_NEAR(m.isotropy, std::sqrt(0.5), kRounding);
  EXPECT_NEAR(m.sqrt_det, std::sqrt(27 * 1.5 * 1.5 * 3), 10 * kRounding);
}

TEST(SingularMeasures, OfARegularTetrahedron) {
  const SingularMeasures m = ComputeSingularMeasures(Tetrahedron(kScale, 0.8), kScale);
  EXPECT_NEAR(m.min_singular_value, std::sqrt(8.0 / 3), kRounding);
  EXPECT_NEAR(m.isotropy, std::sqrt(2.0 / 3), kRounding);
  EXPECT_NEAR(m.sqrt_det, std::pow(4 * 8.0 / 3, 1.5), 100 * kRounding);
}

TEST(SingularMeasures, OfTwoContactsMissTheTorsionAboutTheirLine) {
  RandomStream random(2, 0);
  for (int i = 0; i < 20; ++i) {
    const SingularMeasures m = ComputeSingularMeasures(Random(random, 2), kScale);
    EXPECT_EQ(m.min_singular_value, 0.0);
    EXPECT_EQ(m.sqrt_det, 0.0);
    EXPECT_EQ(m.isotropy, 0.0);
  }
}

TEST(SingularMeasures, OfOneContactOrNoneAreZero) {
  EXPECT_EQ(ComputeSingularMeasures({}, kScale).min_singular_value, 0.0);
  EXPECT_EQ(ComputeSingularMeasures(Ring(1, kScale, 0.8), kScale).sqrt_det, 0.0);
}

Eigen::VectorXd SingularValues(const Contacts& contacts, double scale) {
  Eigen::MatrixXd G(6, 3 * contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const TangentBasis b = ContactTangents(contacts[i].inward_normal);
    int column = 3 * static_cast<int>(i);
    for (const Vector3d& f : {b.t1, b.t2, contacts[i].inward_normal})
      G.col(column++) << f, contacts[i].position.cross(f) / scale;
  }
  return Eigen::JacobiSVD<Eigen::MatrixXd>(G).singularValues();
}

TEST(SingularMeasures, AgreeWithTheSvdOfG) {
  RandomStream random(3, 0);
  for (int i = 0; i < 200; ++i) {
    const Contacts contacts = Random(random, 3 + i % 6);
    const Eigen::VectorXd sigma = SingularValues(contacts, kScale);
    const SingularMeasures m = ComputeSingularMeasures(contacts, kScale);
    EXPECT_NEAR(m.min_singular_value, sigma(5),
                1e-10);  // eigenvalue rounding 1e-15 over sigma > 1e-3
    EXPECT_NEAR(m.sqrt_det, sigma.prod(), 1e-10);
    EXPECT_NEAR(m.isotropy, sigma(5) / sigma(0), 1e-10);
  }
}

TEST(SingularMeasures, KeepSixDigitsNearASingularity) {
  for (double offset = 1e-8; offset < 1e-2; offset *= 3) {
    Contacts contacts = OnSphere({{1, 0, 0}, {-1, 0, 0}, {1, offset, 0}}, kScale, 0.8);
    const double sigma = SingularValues(contacts, kScale)(5);
    // G Gᵀ squares: sigma is known to the root of its rounding, the promised 1e-7 of the largest
    // (1.7).
    EXPECT_NEAR(ComputeSingularMeasures(contacts, kScale).min_singular_value, sigma, 2e-7);
  }
}

TEST(SingularMeasures, DoNotDependOnTheFrameNorTheUnitOfLength) {
  RandomStream random(4, 0);
  for (int i = 0; i < 50; ++i) {
    const Contacts contacts = Random(random, 4);
    const double expected = ComputeSingularMeasures(contacts, kScale).min_singular_value;
    Contacts other = Rotated(contacts, RandomRotation(random));
    EXPECT_NEAR(ComputeSingularMeasures(other, kScale).min_singular_value, expected, 1e-10);
    for (GraspContact& c : other) c.position *= 1000;
    EXPECT_NEAR(ComputeSingularMeasures(other, 1000 * kScale).min_singular_value, expected, 1e-10);
  }
}

}  // namespace
}  // namespace regrasp
