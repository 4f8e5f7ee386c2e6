#include "core/world/collision.h"

#include <algorithm>
#include <utility>

namespace regrasp {
namespace {

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

}  // namespace

Collider::Collider(const HandModel& hand, const Articulation& articulation,
                   const ObjectModel& object, const std::vector<dBodyID>& bodies,
                   const std::vector<Isometry3d>& X_WL, dBodyID object_body)
    : object_(object, object_body) {
  for (std::size_t link = 0; link < hand.links.size(); ++link) {
    // From the link frame to the frame of the body, or to W for the static palm.
    Isometry3d X_BL = X_WL[link];
    const int b = articulation.body_of_link[link];
    if (b >= 0) {
      X_BL = Isometry3d::Identity();
      X_BL.translation() = -articulation.bodies[b].p_LB;
    }
    const auto& shapes = hand.links[link].shapes;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      parts_.push_back(
          PartOf(shapes[s], static_cast<int>(link), b >= 0 ? bodies[b] : nullptr, X_BL));
      parts_.back().shape = static_cast<int>(s);
    }
  }

  for (std::size_t i = 0; i < parts_.size(); ++i) {
    for (std::size_t j = i + 1; j < parts_.size(); ++j) {
      const CollisionPart &a = parts_[i], &b = parts_[j];
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
  for (CollisionPart& part : parts_)
    if (part.geom) dGeomDestroy(part.geom);
  if (object_.geom) dGeomDestroy(object_.geom);
}

void Collider::Abandon() {
  for (CollisionPart& part : parts_) part.geom = nullptr;
  object_.geom = nullptr;
}

void Collider::Collide(FixedVector<ObjectHit, kMaxObjectContacts>* object_hits,
                       FixedVector<LinkHit, kMaxLinkHits>* link_hits) {
  object_hits->clear();
  link_hits->clear();
  for (CollisionPart& part : parts_)
    if (part.body) part.p_WM = PointNow(part.body, part.p_BM);
  object_.p_WM = PointNow(object_.body, Vector3d::Zero());
  dContactGeom found[kMaxPerPair];
  for (const CollisionPart& part : parts_) {
    if (!MayTouch(part, object_)) continue;
    const int n = object_.ContactsWith(part, found);
    for (int k = 0; k < n; ++k) Keep({part.link, part.shape, part.body, found[k]}, object_hits);
  }
  for (const Pair& pair : pairs_) {
    const CollisionPart &a = parts_[pair.a], &b = parts_[pair.b];
    if (!MayTouch(a, b)) continue;
    const int n = Contacts(a, b, found);
    for (int k = 0; k < n; ++k) Keep({a.link, b.link, a.body, b.body, found[k]}, link_hits);
  }
}

}  // namespace regrasp
