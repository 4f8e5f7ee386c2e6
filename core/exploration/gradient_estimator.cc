#include "core/exploration/gradient_estimator.h"

namespace regrasp {

Vector3d SecantEstimator::Gradient(const Vector3d& p_WC_prev, double phi_prev, const Vector3d& p_WC,
                                   double phi, const Matrix3d& R_WC, double min_displacement) {
  const Vector3d dc_C = R_WC.transpose() * (p_WC_prev - p_WC);  // line 5
  Vector3d gradient_C = Vector3d::Zero();                       // line 6
  for (int axis = 0; axis < 2; ++axis)
    if (std::abs(dc_C[axis]) >= 0.25 * min_displacement)
      gradient_C[axis] = (phi_prev - phi) / dc_C[axis];
  return gradient_C;
}

void LeastSquaresEstimator::Add(const Vector3d& p_WC, double phi, double keep) {
  const double old = keep * weight_;
  weight_ = old + 1.0;
  const Vector3d d = p_WC - mean_p_;
  const double d_phi = phi - mean_phi_;
  mean_p_ += d / weight_;
  mean_phi_ += d_phi / weight_;
  const double share = old / weight_;
  scatter_ = keep * scatter_ + share * d * d.transpose();
  cross_ = keep * cross_ + share * d * d_phi;
}

Vector3d LeastSquaresEstimator::Gradient(const Matrix3d& R_WC, double ridge) const {
  if (weight_ <= 1.0) return Vector3d::Zero();
  const Eigen::Matrix<double, 3, 2> tangents = R_WC.leftCols<2>();
  const Eigen::Matrix2d A =
      tangents.transpose() * scatter_ * tangents / weight_ + ridge * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d b = tangents.transpose() * cross_ / weight_;
  const Eigen::Vector2d g = A.inverse() * b;
  return {g.x(), g.y(), 0.0};
}

}  // namespace regrasp
