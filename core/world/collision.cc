#include "core/world/collision.h"

#include <algorithm>
#include <utility>

#include "core/world/last_mesh.h"

namespace regrasp {
namespace {

constexpr int kMaxPerPair = 4;

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

Matrix3d RotationOf(dBodyID body) {
  const dReal* R = dBodyGetRotation(body);
  Matrix3d M;
  M << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
  return M;
}

// The point p_B of a body, in W.
Vector3d PointNow(dBodyID body, const Vector3d& p_B) {
  const dReal* p = dBodyGetPosition(body);
  return Vector3d(p[0], p[1], p[2]) + RotationOf(body) * p_B;
}

// Appends the hit; where there is no room the shallowest is left out. The order stays.
template <typename Hit, std::size_t n>
void Keep(const Hit& hit, FixedVector<Hit, n>* hits) {
  if (hits->full()) {
    Hit* const shallowest =
        std::min_element(hits->begin(), hits->end(),
                         [](const Hit& a, const Hit& b) { return a.geom.depth < b.geom.depth; });
    if (hit.geom.depth <= shallowest->geom.depth) return;
    std::move(shallowest + 1, hits->end(), shallowest);
    hits->resize(n - 1);
  }
  hits->push_back(hit);
}

// Distance of a point from a box, given in the box frame.
double DistanceToBox(const Vector3d& p, const Vector3d& half) {
  return (p.cwiseAbs() - half).cwiseMax(0.0).norm();
}

std::shared_ptr<const OdeMesh> SharedOdeMesh(const ObjectModel& object) {
  static LastMesh<OdeMesh> last;
  return last.Of(object.vertices_O, object.triangles);
}

}  // namespace

OdeMesh::OdeMesh(const std::vector<Vector3d>& vertices_O,
                 const std::vector<Eigen::Vector3i>& triangles)
    : data_(dGeomTriMeshDataCreate()) {
  for (const Vector3d& v : vertices_O) vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
  for (const Eigen::Vector3i& t : triangles)
    for (int k = 0; k < 3; ++k) indices_.push_back(static_cast<dTriIndex>(t[k]));
  dGeomTriMeshDataBuildDouble(data_, vertices_.data(), 3 * sizeof(double),
                              static_cast<int>(vertices_O.size()), indices_.data(),
                              static_cast<int>(indices_.size()), 3 * sizeof(dTriIndex));
}

Collider::Collider(const HandModel& hand, const Articulation& articulation,
                   const ObjectModel& object, const std::vector<dBodyID>& bodies,
                   const std::vector<Isometry3d>& X_WL, dBodyID object_body) {
  for (std::size_t link = 0; link < hand.links.size(); ++link) {
    for (const Shape& shape : hand.links[link].shapes) {
      const int b = articulation.body_of_link[link];
      Part part;
      part.link = static_cast<int>(link);
      part.body = b >= 0 ? bodies[b] : nullptr;
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
      // From the link frame to the frame of the body, or to W for the static palm.
      Isometry3d X_BL = X_WL[link];
      if (b >= 0) {
        X_BL = Isometry3d::Identity();
        X_BL.translation() = -articulation.bodies[b].p_LB;
      }
      const Isometry3d X_BS = X_BL * X_LS;
      SetOffset(part.geom, part.body, X_BS);
      part.X_WS = X_BS;
      part.p_BM = X_BS.translation();
      part.p_BA = X_BL * shape.a_L;
      part.p_BC = X_BL * shape.b_L;
      part.p_WM = part.body ? PointNow(part.body, part.p_BM) : part.p_BM;
      parts_.push_back(part);
    }
  }

  switch (object.kind) {
    case ObjectModel::Kind::kSphere:
      object_.geom = dCreateSphere(nullptr, object.radius);
      break;
    case ObjectModel::Kind::kCapsule:
      object_.geom = dCreateCapsule(nullptr, object.radius, 2 * object.half_length);
      break;
    case ObjectModel::Kind::kBox:
      object_.geom = dCreateBox(nullptr, 2 * object.half_extents.x(), 2 * object.half_extents.y(),
                                2 * object.half_extents.z());
      object_.box = true;
      object_.half = object.half_extents;
      break;
    case ObjectModel::Kind::kMesh:
      surface_ = SurfaceMesh::Shared(object.vertices_O, object.triangles);
      mesh_ = SharedOdeMesh(object);
      object_.geom = dCreateTriMesh(nullptr, mesh_->data(), nullptr, nullptr, nullptr);
      object_.box = true;  // may rest on a box with several contacts
      break;
  }
  object_.body = object_body;
  object_.bound = object.bounding_radius;
  dGeomSetBody(object_.geom, object_body);

  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for (std::size_t j = i + 1; j < parts_.size(); ++j) {
      const Part &a = parts_[i], &b = parts_[j];
      if (a.body == b.body) continue;
      const int body_a = articulation.body_of_link[a.link];
      const int body_b = articulation.body_of_link[b.link];
      const bool neighbours = (body_a >= 0 && articulation.bodies[body_a].parent == body_b) ||
                              (body_b >= 0 && articulation.bodies[body_b].parent == body_a);
      dContactGeom unused[kMaxPerPair];
      if (neighbours || Contacts(a, b, unused) > 0) continue;
      pairs_.push_back({static_cast<int>(i), static_cast<int>(j)});
    }
  }
}

Collider::~Collider() {
  for (Part& part : parts_)
    if (part.geom) dGeomDestroy(part.geom);
  if (object_.geom) dGeomDestroy(object_.geom);
}

void Collider::Abandon() {
  for (Part& part : parts_) part.geom = nullptr;
  object_.geom = nullptr;
}

bool Collider::MayTouch(const Part& a, const Part& b) const {
  const double reach = a.bound + b.bound;
  if ((a.p_WM - b.p_WM).squaredNorm() > reach * reach) return false;
  if (a.box && a.body == nullptr)
    return DistanceToBox(a.X_WS.linear().transpose() * (b.p_WM - a.X_WS.translation()), a.half) <=
           b.bound;
  return true;
}

int Collider::Contacts(const Part& a, const Part& b, dContactGeom* out) {
  const int wanted = a.box && b.box ? kMaxPerPair : 1;
  dContactGeom found[8];
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

int Collider::ObjectContacts(const Part& part, dContactGeom* out) const {
  return surface_ && !part.box ? MeshContact(part, out) : Contacts(object_, part, out);
}

int Collider::MeshContact(const Part& part, dContactGeom* out) const {
  const Matrix3d R_WO = RotationOf(object_.body);
  const auto in_object = [&](const Vector3d& p_B) -> Vector3d {
    const Vector3d p_W = part.body ? PointNow(part.body, p_B) : p_B;
    return R_WO.transpose() * (p_W - object_.p_WM);
  };
  const std::optional<SurfaceMesh::Closest> closest =
      surface_->ClosestToSegment(in_object(part.p_BA), in_object(part.p_BC), part.radius);
  if (!closest) return 0;
  // The normal runs from the surface to the capsule's core; where the core has gone under the
  // surface the two change places.
  const Vector3d gap = closest->p_OSegment - closest->p_OSurface;
  const bool inside = gap.dot(closest->face_normal_O) < 0;
  const double distance = inside ? -closest->distance : closest->distance;
  const Vector3d normal_O =
      closest->distance > 1e-9 ? Vector3d(gap / distance) : closest->face_normal_O;
  const double depth = part.radius - distance;
  const Vector3d p_W = R_WO * (closest->p_OSurface - 0.5 * depth * normal_O) + object_.p_WM;
  const Vector3d normal_W = R_WO * normal_O;
  *out = dContactGeom{};
  for (int k = 0; k < 3; ++k) {
    out->pos[k] = p_W[k];
    out->normal[k] = -normal_W[k];
  }
  out->depth = depth;
  return 1;
}

void Collider::Collide(FixedVector<ObjectHit, kMaxObjectContacts>* object_hits,
                       FixedVector<LinkHit, kMaxLinkHits>* link_hits) {
  object_hits->clear();
  link_hits->clear();
  for (Part& part : parts_)
    if (part.body) part.p_WM = PointNow(part.body, part.p_BM);
  object_.p_WM = PointNow(object_.body, Vector3d::Zero());
  dContactGeom found[kMaxPerPair];
  for (const Part& part : parts_) {
    if (!MayTouch(part, object_)) continue;
    const int n = ObjectContacts(part, found);
    for (int k = 0; k < n; ++k) Keep({part.link, part.body, found[k]}, object_hits);
  }
  for (const Pair& pair : pairs_) {
    const Part &a = parts_[pair.a], &b = parts_[pair.b];
    if (!MayTouch(a, b)) continue;
    const int n = Contacts(a, b, found);
    for (int k = 0; k < n; ++k) Keep({a.link, b.link, a.body, b.body, found[k]}, link_hits);
  }
}

}  // namespace regrasp
