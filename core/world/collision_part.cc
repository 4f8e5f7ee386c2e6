#include "core/world/collision_part.h"

#include <algorithm>
#include <mutex>
#include <utility>

namespace regrasp {
namespace {

void SetOffset(dGeomID geom, dBodyID body, const Isometry3d& X) {
  const Vector3d p = X.translation();
  dMatrix3 R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) R[4 * r + c] = c < 3 ? X.linear()(r, c) : 0.0;
  if (body != nullptr) {
    dGeomSetBody(geom, body);
    dGeomSetOffsetPosition(geom, p.x(), p.y(), p.z());
    dGeomSetOffsetRotation(geom, R);
  } else {
    dGeomSetPosition(geom, p.x(), p.y(), p.z());
    dGeomSetRotation(geom, R);
  }
}

// Distance of a point from a box, given in the box frame.
double DistanceToBox(const Vector3d& p, const Vector3d& half) {
  return (p.cwiseAbs() - half).cwiseMax(0.0).norm();
}

}  // namespace

CollisionPart PartOf(const Shape& shape, int link, dBodyID body, const Isometry3d& X_BL) {
  CollisionPart part;
  part.link = link;
  part.body = body;
  Isometry3d X_LS = Isometry3d::Identity();
  if (shape.kind == Shape::Kind::kBox) {
    part.box = true;
    part.half = shape.half_extents;
    part.bound = shape.half_extents.norm();
    part.geom = dCreateBox(nullptr, 2 * shape.half_extents.x(), 2 * shape.half_extents.y(),
                           2 * shape.half_extents.z());
    X_LS = shape.X_LB;
  } else {
    const Vector3d along = shape.b_L - shape.a_L;
    const double length = along.norm();
    X_LS.translation() = 0.5 * (shape.a_L + shape.b_L);
    part.bound = shape.radius + 0.5 * length;
    part.radius = shape.radius;
    if (length > 1e-9) {
      X_LS.linear() = RotationFromZ(along / length);
      part.geom = dCreateCapsule(nullptr, shape.radius, length);
    } else {
      part.geom = dCreateSphere(nullptr, shape.radius);
    }
  }
  const Isometry3d X_BS = X_BL * X_LS;
  SetOffset(part.geom, part.body, X_BS);
  part.X_WS = X_BS;
  part.p_BM = X_BS.translation();
  part.p_BA = X_BL * shape.a_L;
  part.p_BC = X_BL * shape.b_L;
  part.p_WM = part.body ? PointNow(part.body, part.p_BM) : part.p_BM;
  return part;
}

Matrix3d RotationOf(dBodyID body) {
  const dReal* R = dBodyGetRotation(body);
  Matrix3d M;
  M << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
  return M;
}

Vector3d PointNow(dBodyID body, const Vector3d& p_B) {
  const dReal* p = dBodyGetPosition(body);
  return Vector3d(p[0], p[1], p[2]) + RotationOf(body) * p_B;
}

bool MayTouch(const CollisionPart& a, const CollisionPart& b) {
  const double reach = a.bound + b.bound;
  if ((a.p_WM - b.p_WM).squaredNorm() > reach * reach) return false;
  if (a.box && a.body == nullptr)
    return DistanceToBox(a.X_WS.linear().transpose() * (b.p_WM - a.X_WS.translation()), a.half) <=
           b.bound;
  return true;
}

int Contacts(const CollisionPart& a, const CollisionPart& b, dContactGeom* out) {
  const int wanted = a.box && b.box ? kMaxPerPair : 1;
  dContactGeom found[8];
  // Built without thread-local storage, as Debian has it, ODE has one workspace for meshes in all
  // threads. Of the daemon's only the control loop collides meshes (links have none): it never
  // waits.
  static std::mutex workspace;
  std::unique_lock lock(workspace, std::defer_lock);
  if (dGeomGetClass(a.geom) == dTriMeshClass || dGeomGetClass(b.geom) == dTriMeshClass) lock.lock();
  const int n = dCollide(a.geom, b.geom, 8, found, sizeof(dContactGeom));
  const int kept = std::min(n, wanted);
  for (int k = 0; k < kept; ++k) {
    dContactGeom* deepest = std::max_element(
        found + k, found + n,
        [](const dContactGeom& x, const dContactGeom& y) { return x.depth < y.depth; });
    std::swap(found[k], *deepest);
    out[k] = found[k];
  }
  return kept;
}

}  // namespace regrasp
