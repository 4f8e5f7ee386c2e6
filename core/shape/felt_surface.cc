#include "core/shape/felt_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace regrasp {
namespace {

constexpr double kLeastRadius = 0.001;  // [m]

double Square(double x) { return x * x; }

/// Equal angles instead of equal lengths on the cube's face, and back; both on [-1, 1].
double ToGrid(double u) { return std::atan(u) * (4.0 / std::numbers::pi); }
double FromGrid(double s) { return std::tan(s * (std::numbers::pi / 4.0)); }

}  // namespace

double FeltSurface::Weight(double angle2) const {
  const double x = angle2 + Square(parameters_.near);
  return 1.0 / (x * x);
}

int FeltSurface::CellOf(const Vector3d& d) {
  int axis = 0;
  d.cwiseAbs().maxCoeff(&axis);
  const double major = d[axis];
  const auto Index = [&](double value) {
    const double s = ToGrid(value / std::abs(major));
    return std::clamp(static_cast<int>((s + 1.0) * 0.5 * kGrid), 0, kGrid - 1);
  };
  const int face = 2 * axis + (major < 0 ? 1 : 0);
  return (face * kGrid + Index(d[(axis + 1) % 3])) * kGrid + Index(d[(axis + 2) % 3]);
}

Vector3d FeltSurface::CellDirection(int i) {
  const int face = i / (kGrid * kGrid), row = i / kGrid % kGrid, column = i % kGrid;
  const int axis = face / 2;
  Vector3d d;
  d[axis] = face % 2 == 0 ? 1.0 : -1.0;
  d[(axis + 1) % 3] = FromGrid(2.0 * (row + 0.5) / kGrid - 1.0);
  d[(axis + 2) % 3] = FromGrid(2.0 * (column + 0.5) / kGrid - 1.0);
  return d.normalized();
}

void FeltSurface::Add(const Vector3d& p_O, const Vector3d& normal_O, int samples) {
  const double radius = p_O.norm();
  if (!(radius > kLeastRadius) || !(normal_O.dot(p_O) > parameters_.least_cosine * radius)) return;
  const int index = CellOf(p_O);
  Cell& cell = cells_[index];
  if (cell.count == 0) touched_[num_touched_++] = static_cast<std::int16_t>(index);
  log_radius_sum_ -= cell.log_radius;
  cell.count = std::max(samples, std::min(cell.count + samples, parameters_.memory));
  const double gain = static_cast<double>(samples) / cell.count;
  cell.log_radius += gain * (std::log(radius) - cell.log_radius);
  cell.direction_sum += gain * (p_O / radius - cell.direction_sum);
  cell.normal_sum += gain * (normal_O - cell.normal_sum);
  log_radius_sum_ += cell.log_radius;
}

SurfacePoint FeltSurface::At(const Vector3d& d_O) const {
  const Vector3d d = d_O.normalized();
  SurfacePoint result;
  if (num_touched_ == 0) {
    result.p_O = parameters_.default_radius * d;
    result.normal_O = d;
    result.unknown = result.bend = std::numbers::pi;
    return result;
  }
  const double mean = log_radius_sum_ / num_touched_;
  const double bend_reach2 = Square(parameters_.bend_reach);
  double weights = Weight(Square(parameters_.prior_angle)), log_radius = weights * mean;
  Vector3d normal = weights * d, near_normals = Vector3d::Zero();
  double near_weights = 0, nearest2 = 4.0;
  for (int k = 0; k < num_touched_; ++k) {
    const Cell& cell = cells_[touched_[k]];
    const Vector3d u = cell.direction_sum.normalized();
    const double cosine = d.dot(u);
    const double angle2 = 2.0 * (1.0 - cosine);  // of the chord; as good as the angle nearby
    const double confidence = std::min(1.0, cell.count / static_cast<double>(parameters_.full));
    const double w = confidence * Weight(angle2);
    weights += w;
    if (cell.count >= parameters_.full / 4) nearest2 = std::min(nearest2, angle2);
    if (angle2 > 1.0) {  // too far for its slope and its normal
      log_radius += w * cell.log_radius;
      normal += w * d;
      continue;
    }
    const Vector3d n = cell.normal_sum.normalized();
    const double along = n.dot(u);
    Vector3d slope = -(n - along * u) / along;
    const double steep = slope.norm();
    if (steep > parameters_.steepest) slope *= parameters_.steepest / steep;
    log_radius +=
        w * (cell.log_radius + slope.dot(d) * std::exp(-angle2 / parameters_.slope_reach2));
    const double turn = 1.0 - std::exp(-angle2 / parameters_.turn_reach2);
    const Vector3d turned = n + turn * (n.dot(d) > 0 ? 1.0 : 0.0) * (d - u);
    normal += w * turned.normalized();
    if (angle2 < bend_reach2) {
      near_weights += confidence;
      near_normals += confidence * cell.normal_sum;  // shorter than 1 where it bends inside
    }
  }
  result.p_O = std::exp(log_radius / weights) * d;
  result.normal_O = normal.normalized();
  result.unknown = 2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(std::max(0.0, nearest2))));
  if (near_weights > 0)
    result.bend = std::sqrt(std::max(0.0, 2.0 * (1.0 - near_normals.norm() / near_weights)));
  return result;
}

double FeltSurface::BendAt(const Vector3d& d_O) const {
  const Vector3d d = d_O.normalized();
  const double bend_reach2 = Square(parameters_.bend_reach);
  Vector3d normals = Vector3d::Zero();
  double weights = 0;
  for (int k = 0; k < num_touched_; ++k) {
    const Cell& cell = cells_[touched_[k]];
    // The sum is shorter than a unit vector by no more than a cell's width: near enough to sort
    // out.
    if (d.dot(cell.direction_sum) < 1.0 - bend_reach2) continue;
    if (2.0 * (1.0 - d.dot(cell.direction_sum.normalized())) >= bend_reach2) continue;
    const double confidence = std::min(1.0, cell.count / static_cast<double>(parameters_.full));
    weights += confidence;
    normals += confidence * cell.normal_sum;
  }
  return weights > 0 ? std::sqrt(std::max(0.0, 2.0 * (1.0 - normals.norm() / weights))) : 0.0;
}

double FeltSurface::mean_radius() const {
  return num_touched_ == 0 ? parameters_.default_radius : std::exp(log_radius_sum_ / num_touched_);
}

}  // namespace regrasp
