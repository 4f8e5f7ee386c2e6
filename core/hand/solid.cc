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

/// The inside of closed surfaces as bars along z on a square grid, 160 of them across the larger
/// side. A bar is inside where more surfaces have been entered than left.
class Columns {
 public:
  explicit Columns(const TriangleMesh& mesh) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& v : mesh.vertices) box.extend(v);
    cell_ = std::max(box.sizes().x(), box.sizes().y()) / kAcross;
    // Off the middle of a cell by a little, so that no bar runs along a face or through a corner.
    first_ = box.min().head<2>() + cell_ * Eigen::Vector2d(0.50137, 0.49871);
    for (int k = 0; k < 2; ++k) size_[k] = static_cast<int>(box.sizes()[k] / cell_) + 1;
    crossings_.resize(static_cast<std::size_t>(size_.prod()));
    for (const auto& t : mesh.triangles)
      AddTriangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
    for (auto& column : crossings_) std::ranges::sort(column, {}, &Crossing::z);
  }

  /// Calls `bar(middle, area, length, pieces)` for every part of a column that is inside; `pieces`:
  /// of how many closed surfaces.
  template <typename Bar>
  void ForEach(const Bar& bar) const {
    for (std::size_t c = 0; c < crossings_.size(); ++c) {
      const Eigen::Vector2d p =
          At(static_cast<int>(c) / size_.y(), static_cast<int>(c) % size_.y());
      int entered = 0;
      for (std::size_t k = 0; k + 1 < crossings_[c].size(); ++k) {
        entered += crossings_[c][k].enters;
        const double low = crossings_[c][k].z, high = crossings_[c][k + 1].z;
        if (entered > 0)
          bar(Vector3d(p.x(), p.y(), 0.5 * (low + high)), cell_ * cell_, high - low, entered);
      }
    }
  }

 private:
  static constexpr int kAcross = 160;
  struct Crossing {
    double z = 0;
    int enters = 0;  ///< 1 or, where the surface is left, -1
  };

  Eigen::Vector2d At(int i, int j) const { return first_ + cell_ * Eigen::Vector2d(i, j); }

  void AddTriangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
      return u.x() * v.y() - u.y() * v.x();
    };
    const Eigen::Vector2d ab = (b - a).head<2>(), ac = (c - a).head<2>();
    const double area = cross(ab, ac);
    if (area == 0) return;  // upright: no column crosses it
    Eigen::AlignedBox2d shadow(Eigen::Vector2d(a.head<2>()));
    shadow.extend(Eigen::Vector2d(b.head<2>())).extend(Eigen::Vector2d(c.head<2>()));
    Eigen::Vector2i from, to;
    for (int k = 0; k < 2; ++k) {
      from[k] = std::max(0, static_cast<int>(std::ceil((shadow.min()[k] - first_[k]) / cell_)));
      to[k] = std::min(size_[k] - 1,
                       static_cast<int>(std::floor((shadow.max()[k] - first_[k]) / cell_)));
    }
    for (int i = from.x(); i <= to.x(); ++i)
      for (int j = from.y(); j <= to.y(); ++j) {
        const Eigen::Vector2d ap = At(i, j) - a.head<2>();
        const double v = cross(ap, ac) / area, w = cross(ab, ap) / area;
        if (v < 0 || w < 0 || v + w > 1) continue;
        const double z = a.z() + v * (b.z() - a.z()) + w * (c.z() - a.z());
        crossings_[static_cast<std::size_t>(i * size_.y() + j)].push_back({z, area < 0 ? 1 : -1});
      }
  }

  double cell_ = 0;
  Eigen::Vector2d first_;
  Eigen::Vector2i size_;
  std::vector<std::vector<Crossing>> crossings_;
};

/// Each place counted once. Within 0.2 % of the volume.
Solid UnionSolid(const Columns& columns) {
  Solid solid;
  Vector3d moment = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  columns.ForEach([&](const Vector3d& middle, double area, double length, int) {
    solid.volume += area * length;
    moment += area * length * middle;
    second += area * length * middle * middle.transpose();
    // That of the bar itself, of a square base.
    second.diagonal() += area * length / 12 * Vector3d(area, area, length * length);
  });
  if (!(solid.volume > 0)) return solid;
  solid.centre = moment / solid.volume;
  second -= solid.volume * solid.centre * solid.centre.transpose();
  solid.inertia = second.trace() * Matrix3d::Identity() - second;
  return solid;
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

Solid PiecesSolid(const TriangleMesh& mesh, double* overlap) {
  constexpr double kSame = 0.004;
  const Solid sum = MeshSolid(mesh);
  const Columns columns(mesh);
  // By the same columns as the union: where pieces only touch this is 0, however coarse they are.
  double twice = 0;
  columns.ForEach([&](const Vector3d&, double area, double length, int pieces) {
    twice += (pieces - 1) * area * length;
  });
  const bool same = twice <= kSame * sum.volume;
  if (overlap != nullptr) *overlap = same ? 0 : twice;
  return same ? sum : UnionSolid(columns);
}

Solid ObjectSolid(const ObjectModel& object) {
  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
      return SphereSolid(object.radius);
    case ObjectModel::Kind::kBox:
      return BoxSolid(object.half_extents);
    case ObjectModel::Kind::kMesh:
      break;
  }
  return PiecesSolid({object.vertices_O, object.triangles});
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

Vector3d PrincipalMoments(const Matrix3d& inertia) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

std::string WhyNoInertia(const Matrix3d& inertia) {
  const Vector3d moments = PrincipalMoments(inertia);
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

std::string DensityText(double density) {
  return density < 1000 ? fmt::format("{:.4g} kg/m³", density)
                        : fmt::format("{:.0f} kg/m³", density);
}

std::string WhyUnlikely(const ObjectModel& object) {
  constexpr double kShare = 0.1;
  const Solid solid = ObjectSolid(object);
  const Vector3d told = PrincipalMoments(object.I_OCom),
                 uniform = PrincipalMoments(solid.inertia) * (object.mass / solid.volume);
  if ((told.array() >= kShare * uniform.array()).all()) return "";
  return fmt::format(
      "<inertia> has the principal moments {:.4g}, {:.4g}, {:.4g} kg m²; a homogeneous body of "
      "this shape and mass has {:.4g}, {:.4g}, {:.4g}",
      told[0], told[1], told[2], uniform[0], uniform[1], uniform[2]);
}

std::vector<Impossible> WhyNoBody(const ObjectModel& object) {
  std::vector<Impossible> reasons;
  const Solid solid = ObjectSolid(object);
  const double density = object.mass / solid.volume;
  if (!(density >= kLeastDensity && density <= kMostDensity))
    reasons.push_back(
        {fmt::format("<mass> = {:.4g} kg in {:.4g} cm³ is a density of {}; allowed {:g} .. "
                     "{:g} (grams for kilograms, or another scale?)",
                     object.mass, solid.volume * 1e6, DensityText(density), kLeastDensity,
                     kMostDensity),
         false});
  if (object.kind == ObjectModel::Kind::kMesh && OutsideHull(object.vertices_O))
    reasons.push_back(
        {fmt::format("the centre of mass lies outside of the shape, {:.4g} mm from the "
                     "middle of its volume",
                     solid.centre.norm() * 1e3)});
  const double moment = PrincipalMoments(object.I_OCom)[2];
  const double most = object.mass * object.bounding_radius * object.bounding_radius;
  if (moment > most * (1 + 1e-3))
    reasons.push_back({fmt::format(
        "<inertia> has the moment {:.4g} kg m²; possible is at most m R² = {:.4g}, R = {:.4g} m (a "
        "homogeneous body of this shape has {:.4g})",
        moment, most, object.bounding_radius, density * PrincipalMoments(solid.inertia)[2])});
  return reasons;
}

}  // namespace regrasp
