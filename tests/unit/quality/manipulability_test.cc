#include "core/quality/manipulability.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/common/frames.h"
#include "core/common/random.h"

namespace regrasp {
namespace {

FingerJacobian RandomJacobian(RandomStream& random, int joints) {
  FingerJacobian J(3, joints);
  for (int k = 0; k < joints; ++k) J.col(k) = 0.05 * random.Normal3();
  return J;
}

TEST(Manipulability, OfThreeJointsIsTheAbsoluteDeterminant) {
  RandomStream random(1, 0);
  for (int i = 0; i < 100; ++i) {
    const FingerJacobian J = RandomJacobian(random, 3);
    const Matrix3d square = J;
    // Two ways to round the same six products of size 1e-4.
    EXPECT_NEAR(Manipulability(J), std::abs(square.determinant()), 1e-18);
  }
}

TEST(Manipulability, IsTheRootOfTheDeterminantOfJJt) {
  RandomStream random(2, 0);
  for (int joints = 3; joints <= kMaxFingerJoints; ++joints) {
    const FingerJacobian J = RandomJacobian(random, joints);
    const Matrix3d JJt = J * J.transpose();
    const double expected = std::sqrt(JJt.determinant());
    EXPECT_NEAR(Manipulability(J), expected, 1e-12 * expected);  // well conditioned: rounding only
  }
}

TEST(Manipulability, OfOrthogonalAxesIsTheProductOfTheirLengths) {
  FingerJacobian J = FingerJacobian::Zero(3, 4);
  J(0, 0) = 0.03;
  J(1, 2) = -0.04;
  J(2, 3) = 0.05;
  EXPECT_DOUBLE_EQ(Manipulability(J), 6e-5);
}

TEST(Manipulability, IsZeroForASingularFinger) {
  EXPECT_EQ(Manipulability(FingerJacobian::Zero(3, 0)), 0.0);
  EXPECT_EQ(Manipulability(FingerJacobian::Ones(3, 2)), 0.0);
  RandomStream random(3, 0);
  for (int i = 0; i < 100; ++i) {
    FingerJacobian J = RandomJacobian(random, 5);
    J.row(2) = 0.3 * J.row(0) - 0.7 * J.row(1);
    // det(J Jᵀ) of such a matrix rounds to +-1e-27, whose root is 3e-14 or NaN; the minors round to
    // 1e-21.
    EXPECT_LT(Manipulability(J), 1e-18);
  }
}

TEST(Manipulability, DoesNotDependOnTheFrame) {
  RandomStream random(4, 0);
  const FingerJacobian J = RandomJacobian(random, 4);
  const Matrix3d R = FromRotationVector({0.3, -1.2, 0.8}).toRotationMatrix();
  const FingerJacobian turned = R * J;
  EXPECT_NEAR(Manipulability(turned), Manipulability(J), 1e-12 * Manipulability(J));
}

}  // namespace
}  // namespace regrasp
