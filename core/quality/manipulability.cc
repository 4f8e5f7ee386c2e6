#include "core/quality/manipulability.h"

#include <Eigen/Geometry>
#include <cmath>

namespace regrasp {

double Manipulability(const FingerJacobian& J) {
  // Cauchy-Binet: det(J Jᵀ) is the sum of the squared 3 x 3 minors of J. No term is negative, so
  // nothing cancels near a singularity, where det(J Jᵀ) itself may come out below zero.
  double sum = 0.0;
  const Eigen::Index n = J.cols();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i + 1; j < n; ++j) {
      const Eigen::Vector3d area = J.col(i).cross(J.col(j));
      for (Eigen::Index k = j + 1; k < n; ++k) {
        const double minor = area.dot(J.col(k));
        sum += minor * minor;
      }
    }
  }
  return std::sqrt(sum);
}

}  // namespace regrasp
