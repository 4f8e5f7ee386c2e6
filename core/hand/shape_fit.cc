#include "core/hand/shape_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/hand/hull_support.h"

namespace regrasp {
namespace {

constexpr std::size_t kSamples = 3000;
constexpr double kSphere = 0.05;   // a segment shorter than this share of the radius makes a sphere
constexpr double kThicker = 1.35;  // than its link a fingertip may be: round ends meet boxes
                                   // between their faces and their edges

struct Sample {
  Vector3d p;
  Vector3d normal;  // of its triangle
  double weight = 1;
};
using Samples = std::vector<Sample>;

/// Points spread evenly over the surface: the areas of the triangles one after the other, cut into
/// equal parts, in each a point by two sequences of small discrepancy.
Samples Spread(const TriangleMesh& mesh) {
  double total = 0;
  std::vector<double> until;
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    until.push_back(total += 0.5 * (b - a).cross(c - a).norm());
  }
  Samples samples;
  std::size_t at = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double area = total * (static_cast<double>(i) + 0.5) / kSamples;
    while (at + 1 < until.size() && until[at] < area) ++at;
    const auto& t = mesh.triangles[at];
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(i), 1.0);
    double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(i), 1.0);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Vector3d& a = mesh.vertices[t[0]];
    const Vector3d ab = mesh.vertices[t[1]] - a, ac = mesh.vertices[t[2]] - a;
    samples.push_back({a + u * ab + v * ac, ab.cross(ac).normalized(), 1.0});
  }
  return samples;
}

/// Those on the convex hull, which is what another convex body can touch: no vertex lies beyond the
/// plane of their triangle by more than 0.2 mm. All of them where hardly any does.
Samples Outer(const Samples& samples, const TriangleMesh& mesh) {
  constexpr double kBeyond = 2e-4;
  Samples outer;
  for (const Sample& s : samples) {
    const double height = s.normal.dot(s.p) + kBeyond;
    if (std::ranges::none_of(mesh.vertices,
                             [&](const Vector3d& v) { return s.normal.dot(v) > height; }))
      outer.push_back(s);
  }
  return 10 * outer.size() > samples.size() ? outer : samples;
}

struct Capsule {
  Vector3d a, b;
  double radius = 0;

  double Along(const Vector3d& p) const {
    const Vector3d d = b - a;
    const double d2 = d.squaredNorm();
    return d2 > 0 ? std::clamp((p - a).dot(d) / d2, 0.0, 1.0) : 0.0;
  }
  double Distance(const Vector3d& p) const { return (p - a - Along(p) * (b - a)).norm() - radius; }
};

double Cost(const Samples& samples, const Capsule& capsule) {
  double sum = 0;
  for (const Sample& s : samples) {
    const double d = capsule.Distance(s.p);
    sum += s.weight * d * d;
  }
  return sum;
}

/// Levenberg-Marquardt over both ends and the radius. The derivative of the distance by the ends is
/// -(1 - t) n and -t n: the closest point's own motion along the segment adds nothing.
Capsule Refine(const Samples& samples, Capsule capsule) {
  double cost = Cost(samples, capsule), damping = 1e-3;
  for (int step = 0; step < 100; ++step) {
    Eigen::Matrix<double, 7, 7> H = Eigen::Matrix<double, 7, 7>::Zero();
    Eigen::Matrix<double, 7, 1> g = Eigen::Matrix<double, 7, 1>::Zero();
    for (const Sample& s : samples) {
      const double t = capsule.Along(s.p);
      const Vector3d away = s.p - capsule.a - t * (capsule.b - capsule.a);
      const double length = away.norm();
      if (length < 1e-12) continue;
      Eigen::Matrix<double, 7, 1> row;
      row << -(1 - t) * away / length, -t * away / length, -1;
      H += s.weight * row * row.transpose();
      g += s.weight * (length - capsule.radius) * row;
    }
    const double scale = H.trace() / 7;
    bool better = false;
    for (int attempt = 0; attempt < 8 && !better; ++attempt) {
      Eigen::Matrix<double, 7, 7> A = H;
      A.diagonal().array() += damping * scale;
      const Eigen::Matrix<double, 7, 1> x = A.ldlt().solve(-g);
      Capsule next = capsule;
      next.a += x.head<3>();
      next.b += x.segment<3>(3);
      next.radius += x[6];
      const double next_cost = next.radius > 0 ? Cost(samples, next) : cost;
      better = next.radius > 0 && next_cost < cost;
      damping *= better ? 0.3 : 5;
      if (!better) continue;
      const bool done = cost - next_cost < 1e-9 * cost;
      capsule = next;
      cost = next_cost;
      if (done) return capsule;
    }
    if (!better) break;
  }
  return capsule;
}

/// Centre and principal axes (columns, the longest first) of the points.
void Principal(const Samples& samples, Vector3d* centre, Matrix3d* axes) {
  *centre = Vector3d::Zero();
  double weight = 0;
  for (const Sample& s : samples) {
    *centre += s.weight * s.p;
    weight += s.weight;
  }
  *centre /= weight;
  Matrix3d covariance = Matrix3d::Zero();
  for (const Sample& s : samples)
    covariance += s.weight * (s.p - *centre) * (s.p - *centre).transpose();
  *axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors().rowwise().reverse();
}

/// A capsule around the points with its segment along `axis`.
Capsule Around(const Samples& samples, const Vector3d& centre, const Vector3d& axis) {
  double low = 0, high = 0, radius = 0;
  for (const Sample& s : samples) {
    const Vector3d r = s.p - centre;
    low = std::min(low, r.dot(axis));
    high = std::max(high, r.dot(axis));
    radius += TangentPart(r, axis).norm() / static_cast<double>(samples.size());
  }
  const double inset = std::min(radius, 0.45 * (high - low));
  return {centre + (low + inset) * axis, centre + (high - inset) * axis, radius};
}

void Measure(const Samples& samples, const auto& distance, FittedShape* fit) {
  double sum = 0, weight = 0;
  for (const Sample& s : samples) {
    if (s.weight < 1) continue;
    const double d = std::abs(distance(s.p));
    fit->error_m = std::max(fit->error_m, d);
    sum += d * d;
    weight += 1;
  }
  fit->rms_m = std::sqrt(sum / std::max(1.0, weight));
}

FittedShape ToShape(const Samples& samples, Capsule capsule) {
  if ((capsule.b - capsule.a).norm() < kSphere * capsule.radius)
    capsule.a = capsule.b = 0.5 * (capsule.a + capsule.b);
  FittedShape fit;
  fit.kind = capsule.a == capsule.b ? "sphere" : "capsule";
  fit.shape.a_L = capsule.a;
  fit.shape.b_L = capsule.b;
  fit.shape.radius = capsule.radius;
  Measure(
      samples, [&](const Vector3d& p) { return capsule.Distance(p); }, &fit);
  return fit;
}

FittedShape FitBox(const Samples& samples, const Matrix3d& axes) {
  Eigen::AlignedBox3d box;
  for (const Sample& s : samples) box.extend(Vector3d(axes.transpose() * s.p));
  FittedShape fit;
  fit.kind = "box";
  fit.shape.kind = Shape::Kind::kBox;
  fit.shape.half_extents = (box.sizes() / 2).cwiseMax(1e-4);
  fit.shape.X_LB.linear() = axes;
  fit.shape.X_LB.translation() = axes * box.center();
  Measure(
      samples,
      [&](const Vector3d& p) {
        const Vector3d beyond = (fit.shape.X_LB.inverse() * p).cwiseAbs() - fit.shape.half_extents;
        return beyond.maxCoeff() > 0 ? beyond.cwiseMax(0.0).norm() : beyond.maxCoeff();
      },
      &fit);
  return fit;
}

/// How far the mesh is outside of a capsule.
double LeftOut(const TriangleMesh& mesh, const Shape& shape) {
  const Capsule capsule = {shape.a_L, shape.b_L, shape.radius};
  double most = 0;
  for (const Vector3d& v : mesh.vertices) most = std::max(most, capsule.Distance(v));
  return most;
}

/// The thickest capsule along `axis` from end to end of the mesh, about `middle`, of at most
/// `radius`, that sticks out of the hull by no more than kGoodFit.
Shape Within(const TriangleMesh& mesh, const HullSupport& hull, const Vector3d& middle,
             const Vector3d& axis, double radius) {
  constexpr double kLeast = 1e-4;  // [m]
  double low = 0, high = 0;
  for (const Vector3d& v : mesh.vertices) {
    low = std::min(low, (v - middle).dot(axis));
    high = std::max(high, (v - middle).dot(axis));
  }
  Shape shape;
  for (shape.radius = std::max(kLeast, radius);; shape.radius *= 0.95) {
    shape.a_L = middle + std::min(0.0, low + shape.radius) * axis;
    shape.b_L = middle + std::max(0.0, high - shape.radius) * axis;
    if (shape.radius <= kLeast || hull.Beyond(shape) <= kGoodFit) return shape;
  }
}

/// Such a capsule along the axis that leaves the smallest error, which is that of all of the
/// surface, both ways: how far the link is outside of the capsule, and the capsule of the link.
/// `samples`: of equal weight.
FittedShape FitWithin(const Samples& samples, const TriangleMesh& mesh, const HullSupport& hull,
                      const Matrix3d& axes, const Vector3d& toward) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(Vector3d(axes.transpose() * v));
  int thin = 0;
  const double half = box.sizes().minCoeff(&thin) / 2;
  const Vector3d across = axes.col(thin);
  FittedShape best;
  for (const Vector3d& along :
       {toward, TangentPart(toward, across), Vector3d(axes.col((thin + 1) % 3)),
        Vector3d(axes.col((thin + 2) % 3))}) {
    if (along.norm() < 1e-3) continue;  // the thin side is ahead
    const Shape shape = Within(mesh, hull, axes * box.center(), along.normalized(), half);
    FittedShape fit = ToShape(samples, {shape.a_L, shape.b_L, shape.radius});
    fit.error_m = std::max({fit.error_m, hull.Beyond(fit.shape), LeftOut(mesh, fit.shape)});
    if (best.kind.empty() || fit.error_m < best.error_m - 1e-6) best = fit;
  }
  best.within = true;
  return best;
}

const FittedShape& Nearest(const std::vector<FittedShape>& fits) {
  return *std::min_element(fits.begin(), fits.end(),
                           [](const auto& a, const auto& b) { return a.rms_m < b.rms_m; });
}

}  // namespace

FittedShape FitShape(const TriangleMesh& mesh) {
  const Samples samples = Spread(mesh);
  Vector3d centre;
  Matrix3d axes;
  Principal(samples, &centre, &axes);
  if (axes.determinant() < 0) axes.col(2) *= -1;
  std::vector<FittedShape> fits = {FitBox(samples, Matrix3d::Identity()), FitBox(samples, axes)};
  for (int k = 0; k < 3; ++k)
    fits.push_back(ToShape(samples, Refine(samples, Around(samples, centre, axes.col(k)))));
  return Nearest(fits);
}

FittedShape FitFingertip(const TriangleMesh& mesh, const Vector3d& toward) {
  Samples samples = Outer(Spread(mesh), mesh);
  Vector3d centre;
  Matrix3d axes;
  Principal(samples, &centre, &axes);
  const HullSupport hull(mesh.vertices, axes);
  const FittedShape within = FitWithin(samples, mesh, hull, axes, toward);
  double end = 0, width = 0;
  for (const Sample& s : samples) {
    end = std::max(end, (s.p - centre).dot(toward));
    width = std::max(width, TangentPart(s.p - centre, toward).norm());
  }
  constexpr double kBack = 0.02;  // weight of what does not touch: it keeps the segment in the link
  for (Sample& s : samples)
    if ((s.p - centre).dot(toward) < end - width) s.weight = kBack;
  std::vector<FittedShape> fits;
  std::vector<Vector3d> starts = {toward, axes.col(0), axes.col(1), axes.col(2)};
  for (const Vector3d& axis : starts)
    fits.push_back(ToShape(samples, Refine(samples, Around(samples, centre, axis))));
  const double most = kThicker * hull.WidthAcross(toward) / 2;
  std::erase_if(fits, [&](const FittedShape& fit) {
    return fit.shape.radius > most ||
           hull.BeyondAhead(fit.shape, toward) > std::max(kGoodFit, fit.error_m) ||
           (fit.error_m > kGoodFit && LeftOut(mesh, fit.shape) > fit.shape.radius);
  });
  FittedShape best = fits.empty() ? within : Nearest(fits);
  if (best.shape.a_L.dot(toward) > best.shape.b_L.dot(toward))
    std::swap(best.shape.a_L, best.shape.b_L);
  return best;
}

}  // namespace regrasp
