#include "core/hand/link_body.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/hand/solid.h"

namespace regrasp {
namespace {

Eigen::AlignedBox3d BoxOf(const Shape& shape) {
  Eigen::AlignedBox3d box;
  if (shape.kind == Shape::Kind::kCapsule) {
    const Vector3d r = Vector3d::Constant(shape.radius);
    for (const Vector3d& end : {shape.a_L, shape.b_L})
      box.extend(Eigen::AlignedBox3d(Vector3d(end - r), Vector3d(end + r)));
  } else {
    const Vector3d half = shape.X_LB.linear().cwiseAbs() * shape.half_extents;
    const Vector3d middle = shape.X_LB.translation();
    box.extend(Eigen::AlignedBox3d(Vector3d(middle - half), Vector3d(middle + half)));
  }
  return box;
}

/// About the shapes of a link and its joint.
Eigen::AlignedBox3d BoxOf(const Link& link) {
  Eigen::AlignedBox3d box(Vector3d::Zero());
  for (const Shape& shape : link.shapes) box.extend(BoxOf(shape));
  return box;
}

}  // namespace

void AddBodyTo(Link* link, const UrdfInertial& body, const Isometry3d& X_LG) {
  const double total = link->mass + body.mass;
  const Matrix3d R = body.X_LI.linear();
  const Matrix3d I = R * body.inertia * R.transpose();
  const Vector3d p = X_LG * body.X_LI.translation();
  const Vector3d com =
      total > 0 ? Vector3d((link->mass * link->p_LCom + body.mass * p) / total) : p;
  link->I_LCom += PointInertia(link->mass, link->p_LCom - com) + PointInertia(body.mass, p - com) +
                  X_LG.linear() * I * X_LG.linear().transpose();
  link->mass = total;
  link->p_LCom = com;
}

std::string WhyNoBody(const Link& link, bool told) {
  if (!(link.mass > 0))
    return told ? fmt::format("<mass> = {:g}; must be > 0 for a link that moves", link.mass)
                : "has no <inertial>; a link that moves needs mass > 0";
  if (const std::string why = WhyNoInertia(link.I_LCom); !why.empty()) return why;
  if (link.shapes.empty()) return "";
  const Eigen::AlignedBox3d box = BoxOf(link);
  const double off = std::sqrt(box.squaredExteriorDistance(link.p_LCom));
  if (off <= box.diagonal().norm()) return "";
  return fmt::format(
      "the centre of mass ({:.4g}, {:.4g}, {:.4g}) m is {:.0f} mm outside its "
      "shapes, which are {:.0f} mm across",
      link.p_LCom.x(), link.p_LCom.y(), link.p_LCom.z(), 1e3 * off, 1e3 * box.diagonal().norm());
}

std::string WhyUnlikely(const Link& link) {
  if (link.shapes.empty()) return "";
  const Eigen::AlignedBox3d box = BoxOf(link);
  const Vector3d farthest =
      (box.max() - link.p_LCom).cwiseMax(link.p_LCom - box.min()).cwiseMax(Vector3d::Zero());
  const double R = farthest.norm(), most = link.mass * R * R;
  const double moment = PrincipalMoments(link.I_LCom)[2];
  if (moment <= most) return "";
  return fmt::format(
      "<inertia> has the moment {:.4g} kg m²; a body of its size has at most m R² = {:.4g}, "
      "R = {:.4g} m",
      moment, most, R);
}

std::string WhyTooHeavy(const Link& link) {
  if (link.shapes.empty()) return "";
  const double volume = LinkSolid(link.shapes).volume;
  if (link.mass <= kMostDensity * volume) return "";
  return fmt::format(
      "<mass> = {:.4g} kg in {:.4g} cm³ of <collision> is a density of {}; nothing has "
      "more than {:g} (grams for kilograms, or too small a shape?)",
      link.mass, 1e6 * volume, DensityText(link.mass / volume), kMostDensity);
}

void InventBody(Link* link) {
  constexpr double kDensity = 1100;  // [kg/m³]: plastic with motors and air
  Shape knuckle;                     // of a link without shape
  knuckle.radius = 5e-3;
  const Solid solid = LinkSolid(link->shapes.empty() ? std::vector{knuckle} : link->shapes);
  if (!(link->mass > 0)) link->mass = kDensity * solid.volume;
  link->p_LCom = solid.centre;
  link->I_LCom = solid.inertia * (link->mass / solid.volume);
}

}  // namespace regrasp
