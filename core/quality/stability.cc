#include "core/quality/stability.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace regrasp {

SingularMeasures ComputeSingularMeasures(std::span<const GraspContact> contacts,
                                         double torque_scale) {
  SingularMeasures out;
  if (contacts.size() < 2) return out;

  // t1, t2, n are orthonormal, so G Gᵀ = sum [I, Sᵀ; S, S Sᵀ] with S = [r / torque_scale]x: neither
  // the normals nor the choice of tangents matters.
  Eigen::Matrix<double, 6, 6> GGt = Eigen::Matrix<double, 6, 6>::Zero();
  for (const GraspContact& contact : contacts) {
    const Vector3d r = contact.position / torque_scale;
    Matrix3d S;
    S << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
    GGt.topLeftCorner<3, 3>() += Matrix3d::Identity();
    GGt.bottomLeftCorner<3, 3>() += S;
    GGt.bottomRightCorner<3, 3>() += r.squaredNorm() * Matrix3d::Identity() - r * r.transpose();
  }
  GGt.topRightCorner<3, 3>() = GGt.bottomLeftCorner<3, 3>().transpose();

  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(GGt,
                                                                          Eigen::EigenvaluesOnly);
  const auto& lambda = solver.eigenvalues();  // ascending
  // An eigenvalue is known to a few ulp of the largest one; below that it is a zero of G.
  constexpr double kRounding = 1e-14;
  const double floor = kRounding * lambda(5);
  double product = 1.0;
  for (int i = 0; i < 6; ++i) product *= lambda(i) > floor ? lambda(i) : 0.0;
  out.min_singular_value = lambda(0) > floor ? std::sqrt(lambda(0)) : 0.0;
  out.sqrt_det = std::sqrt(product);
  out.isotropy = out.min_singular_value / std::sqrt(lambda(5));
  return out;
}

}  // namespace regrasp
