#include "core/hand/hull_support.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace regrasp {
namespace {

constexpr int kDirections = 1000;  // of the sphere
constexpr int kAcross = 180;       // of half a circle

double Excess(const Shape& capsule, const Vector3d& d, double height) {
  return std::max(capsule.a_L.dot(d), capsule.b_L.dot(d)) + capsule.radius - height;
}

}  // namespace

HullSupport::HullSupport(const std::vector<Vector3d>& vertices, const Matrix3d& axes)
    : vertices_(vertices) {
  constexpr double kGoldenAngle = 2.399963229728653;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2.0 * i + 1) / kDirections, r = std::sqrt(1 - z * z);
    Add(Vector3d(r * std::cos(kGoldenAngle * i), r * std::sin(kGoldenAngle * i), z));
  }
  for (int k = 0; k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) Add(sign * axes.col(k));
}

double HullSupport::Height(const Vector3d& d) const {
  double height = -std::numeric_limits<double>::infinity();
  for (const Vector3d& v : vertices_) height = std::max(height, v.dot(d));
  return height;
}

double HullSupport::Beyond(const Shape& capsule) const {
  double most = -std::numeric_limits<double>::infinity();
  for (const Direction& at : directions_) most = std::max(most, Excess(capsule, at.d, at.height));
  return most;
}

double HullSupport::BeyondAhead(const Shape& capsule, const Vector3d& toward) const {
  double most = Excess(capsule, toward, Height(toward));
  for (const Direction& at : directions_)
    if (at.d.dot(toward) > -1e-9) most = std::max(most, Excess(capsule, at.d, at.height));
  return most;
}

double HullSupport::WidthAcross(const Vector3d& toward) const {
  const Vector3d u = toward.unitOrthogonal(), v = toward.cross(u);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kAcross; ++i) {
    const double angle = M_PI * i / kAcross;
    const Vector3d d = std::cos(angle) * u + std::sin(angle) * v;
    least = std::min(least, Height(d) + Height(-d));
  }
  return least;
}

}  // namespace regrasp
