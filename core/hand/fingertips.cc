#include "core/hand/fingertips.h"

#include <algorithm>
#include <utility>

namespace regrasp {

/// Each tip link, or where it is a frame without shape, all that it is fixed to. Boxes count where
/// there is nothing rounded.
Fingertips::Fingertips(const HandTree& tree, const HandLayout& layout)
    : tree_(tree), layout_(layout) {
  for (const auto& finger : layout.fingers) {
    const int tip = tree.FindLink(finger.tip_link);
    std::set<int> group;
    if (!tree.link(tip).collisions.empty())
      group.insert(tip);
    else
      tree.AddBodyOf(tip, &group);
    groups_.push_back(group);
    const bool rounded = std::ranges::any_of(group, [&](int l) { return HasRounded(l); });
    for (const int l : group)
      if (!rounded || HasRounded(l)) links_.insert(l);
  }
}

bool Fingertips::HasRounded(int link) const {
  return std::ranges::any_of(tree_.link(link).collisions, [](const UrdfCollision& c) {
    return c.geometry.kind != UrdfGeometry::Kind::kBox;
  });
}

bool Fingertips::Find(std::size_t finger, const Isometry3d& X_LG, const std::vector<int>& origin,
                      Link* link, Finger* out) const {
  const int tip = tree_.FindLink(layout_.fingers[finger].tip_link);
  const bool is_frame = tree_.link(tip).collisions.empty();
  const Vector3d p_tip = X_LG.translation();
  int best = -1;
  double best_score = 0;
  for (std::size_t s = 0; s < link->shapes.size(); ++s) {
    Shape& shape = link->shapes[s];
    if (shape.kind != Shape::Kind::kCapsule || !groups_[finger].contains(origin[s])) continue;
    const auto score = [&](const Vector3d& end) {
      return is_frame && p_tip.norm() > 1e-3 ? shape.radius - (end - p_tip).norm()
                                             : end.norm() + shape.radius;
    };
    if (score(shape.a_L) > score(shape.b_L)) std::swap(shape.a_L, shape.b_L);
    if (best >= 0 && score(shape.b_L) <= best_score) continue;
    best = static_cast<int>(s);
    best_score = score(shape.b_L);
  }
  if (best < 0) return false;
  std::vector<Shape> felt = {link->shapes[static_cast<std::size_t>(best)]}, others;
  for (std::size_t s = 0; s < link->shapes.size(); ++s)
    if (static_cast<int>(s) != best)
      (origin[s] == origin[static_cast<std::size_t>(best)] ? felt : others)
          .push_back(link->shapes[s]);
  out->tip_shapes = static_cast<int>(felt.size());
  link->shapes = std::move(felt);
  link->shapes.insert(link->shapes.end(), others.begin(), others.end());
  out->p_LF = link->shapes.front().b_L;
  out->tip_radius = link->shapes.front().radius;
  return true;
}

}  // namespace regrasp
