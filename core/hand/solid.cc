#include "core/hand/solid.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

/// Adds `part`, posed at X, to `sum`.
void Add(const Solid& part, const Isometry3d& X, Solid* sum) {
  const Vector3d p = X * part.centre;
  const double total = sum->volume + part.volume;
  if (!(total > 0)) return;
  const Vector3d centre = (sum->volume * sum->centre + part.volume * p) / total;
  sum->inertia += PointInertia(sum->volume, sum->centre - centre) +
                  PointInertia(part.volume, p - centre) +
                  X.linear() * part.inertia * X.linear().transpose();
  sum->volume = total;
  sum->centre = centre;
}

/// Whether a plane separates the origin from the points: certified by a direction in which all of
/// them lie on one side [Gilbert 1966: the nearest point of the hull, by support points].
bool OutsideHull(const std::vector<Vector3d>& points) {
  Vector3d x = points.front();
  for (int step = 0; step < 2000; ++step) {
    const Vector3d* support = &points.front();
    for (const Vector3d& p : points)
      if (p.dot(x) < support->dot(x)) support = &p;
    if (support->dot(x) > 1e-6 * x.norm()) return true;  // 1 µm outside
    const Vector3d d = *support - x;
    const double length2 = d.squaredNorm();
    if (length2 == 0) return false;
    x += std::clamp(-x.dot(d) / length2, 0.0, 1.0) * d;
    if (x.squaredNorm() < 1e-16) return false;
  }
  return false;
}

}  // namespace

Matrix3d PointInertia(double mass, const Vector3d& p) {
  return mass * (p.squaredNorm() * Matrix3d::Identity() - p * p.transpose());
}

Solid SphereSolid(double radius) {
  Solid solid;
  solid.volume = 4.0 / 3 * M_PI * std::pow(radius, 3);
  solid.inertia = 0.4 * solid.volume * radius * radius * Matrix3d::Identity();
  return solid;
}

Solid BoxSolid(const Vector3d& half_extents) {
  Solid solid;
  solid.volume = 8 * half_extents.prod();
  const Vector3d squares = half_extents.cwiseAbs2();
  solid.inertia = (solid.volume / 3 * (Vector3d::Constant(squares.sum()) - squares)).asDiagonal();
  return solid;
}

Solid CapsuleSolid(double radius, double half_length) {
  const double r2 = radius * radius, h = half_length;
  const double tube = 2 * M_PI * r2 * h, ball = 4.0 / 3 * M_PI * r2 * radius;
  Solid solid;
  solid.volume = tube + ball;
  const double across = tube * (r2 / 4 + h * h / 3) + ball * (0.4 * r2 + h * h + 0.75 * h * radius);
  const double along = tube * r2 / 2 + ball * 0.4 * r2;
  solid.inertia = Vector3d(across, across, along).asDiagonal();
  return solid;
}

Solid MeshSolid(const TriangleMesh& mesh) {
  // Second moments about the origin: for a tetrahedron with the corners 0, a, b, c,
  // ∫ x xᵀ = det / 120 (s sᵀ + a aᵀ + b bᵀ + c cᵀ), s = a + b + c.
  double six_volumes = 0;
  Vector3d moment = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double det = a.dot(b.cross(c));
    const Vector3d s = a + b + c;
    six_volumes += det;
    moment += det * s;
    second +=
        det / 120 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  Solid solid;
  solid.volume = six_volumes / 6;
  solid.centre = moment / (4 * six_volumes);
  second -= solid.volume * solid.centre * solid.centre.transpose();
  solid.inertia = second.trace() * Matrix3d::Identity() - second;
  return solid;
}

Solid ObjectSolid(const ObjectModel& object) {
  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
      return SphereSolid(object.radius);
    case ObjectModel::Kind::kBox:
      return BoxSolid(object.half_extents);
    case ObjectModel::Kind::kCapsule:
      return CapsuleSolid(object.radius, object.half_length);
    case ObjectModel::Kind::kMesh:
      break;
  }
  return MeshSolid({object.vertices_O, object.triangles});
}

Solid LinkSolid(const std::vector<Shape>& shapes) {
  Solid sum;
  for (const Shape& shape : shapes) {
    if (shape.kind == Shape::Kind::kBox) {
      Add(BoxSolid(shape.half_extents), shape.X_LB, &sum);
      continue;
    }
    const Vector3d along = shape.b_L - shape.a_L;
    Isometry3d X = Isometry3d::Identity();
    X.translation() = 0.5 * (shape.a_L + shape.b_L);
    if (along.norm() > 1e-9) X.linear() = RotationFromZ(along.normalized());
    Add(CapsuleSolid(shape.radius, along.norm() / 2), X, &sum);
  }
  return sum;
}

std::string WhyNoInertia(const Matrix3d& inertia) {
  const Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(moments[0] > 0))
    return fmt::format("<inertia> has the principal moment {:.4g}; all three must be > 0",
                       moments[0]);
  if (moments[2] > (moments[0] + moments[1]) * (1 + 1e-3))
    return fmt::format(
        "<inertia> has the principal moments {:.4g}, {:.4g}, {:.4g}; none may exceed the sum of "
        "the other two",
        moments[0], moments[1], moments[2]);
  return "";
}

std::vector<Impossible> WhyNoBody(const ObjectModel& object) {
  const auto largest = [](const Matrix3d& I) {
    return Eigen::SelfAdjointEigenSolver<Matrix3d>(I, Eigen::EigenvaluesOnly).eigenvalues()[2];
  };
  std::vector<Impossible> reasons;
  const Solid solid = ObjectSolid(object);
  const double density = object.mass / solid.volume;
  if (!(density >= kLeastDensity && density <= kMostDensity))
    reasons.push_back(
        {fmt::format(
             "<mass> = {:.4g} kg in {:.4g} cm³ is a density of {:.4g} kg/m³; allowed {:g} .. "
             "{:g} (grams for kilograms, or another scale?)",
             object.mass, solid.volume * 1e6, density, kLeastDensity, kMostDensity),
         false});
  if (object.kind == ObjectModel::Kind::kMesh && OutsideHull(object.vertices_O))
    reasons.push_back(
        {fmt::format("the centre of mass lies outside of the shape, {:.4g} mm from the "
                     "middle of its volume",
                     solid.centre.norm() * 1e3)});
  const double moment = largest(object.I_OCom);
  const double most = object.mass * object.bounding_radius * object.bounding_radius;
  if (moment > most * (1 + 1e-3))
    reasons.push_back({fmt::format(
        "<inertia> has the moment {:.4g} kg m²; possible is at most m R² = {:.4g}, R = {:.4g} m (a "
        "homogeneous body of this shape has {:.4g})",
        moment, most, object.bounding_radius, density * largest(solid.inertia))});
  return reasons;
}

}  // namespace regrasp
