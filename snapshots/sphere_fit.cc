#include "snapshots/sphere_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace regrasp {
namespace {

using Matrix4d = Eigen::Matrix4d;
using Vector4d = Eigen::Vector4d;

/// Below this ratio of the smallest to the largest principal spread the points count as a plane: a
/// cap of a sphere that flat would leave the radius to the noise.
constexpr double kFlat = 1e-3;

}  // namespace

std::optional<SphereFit> FitSphere(std::span<const Vector3d> points) {
  if (points.size() < 5) return std::nullopt;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Matrix3d spread = Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  const Vector3d principal = Eigen::SelfAdjointEigenSolver<Matrix3d>(spread).eigenvalues();
  if (!(principal[2] > 0) || std::sqrt(std::max(0.0, principal[0]) / principal[2]) < kFlat)
    return std::nullopt;

  // Algebraic: |p|² = 2 c·p + (r² − |c|²), linear in c and the bracket; about the mean, scaled to
  // unit size.
  const double scale = std::sqrt(principal[2] / static_cast<double>(points.size()));
  Matrix4d A = Matrix4d::Zero();
  Vector4d b = Vector4d::Zero();
  for (const Vector3d& point : points) {
    const Vector3d p = (point - mean) / scale;
    const Vector4d row(2 * p.x(), 2 * p.y(), 2 * p.z(), 1);
    A += row * row.transpose();
    b += row * p.squaredNorm();
  }
  const Vector4d x = A.ldlt().solve(b);
  Vector3d c = x.head<3>();
  double r = std::sqrt(x[3] + c.squaredNorm());

  for (int i = 0; i < 20; ++i) {
    A.setZero();
    b.setZero();
    for (const Vector3d& point : points) {
      const Vector3d d = (point - mean) / scale - c;
      const double distance = std::max(1e-12, d.norm());
      Vector4d row;
      row << d / distance, 1;
      A += row * row.transpose();
      b += row * (distance - r);
    }
    const Vector4d step = A.ldlt().solve(b);
    c += step.head<3>();
    r += step[3];
    if (step.norm() < 1e-12) break;
  }
  double sum = 0;
  for (const Vector3d& point : points) {
    const double error = ((point - mean) / scale - c).norm() - r;
    sum += error * error;
  }
  SphereFit fit{mean + scale * c, scale * r,
                scale * std::sqrt(sum / static_cast<double>(points.size()))};
  if (!fit.centre.allFinite() || !std::isfinite(fit.radius)) return std::nullopt;
  return fit;
}

}  // namespace regrasp
