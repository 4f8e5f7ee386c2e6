#include "core/hand/link_body.h"

#include "core/hand/solid.h"

namespace regrasp {

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
