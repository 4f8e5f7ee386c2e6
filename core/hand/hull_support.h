#pragma once

/// How far the convex hull of a mesh reaches, by direction, and how far a capsule sticks out of it:
/// between convex bodies that is the largest excess of the one's support over the other's. Over
/// directions spread evenly, some 6 degrees apart, and axes that are given. Used only by
/// shape_fit.cc.

#include <vector>

#include "core/hand/hand_model.h"

namespace regrasp {

class HullSupport {
 public:
  /// Keeps `vertices` by reference. `axes`: those of faces, if any are known (columns, unit).
  HullSupport(const std::vector<Vector3d>& vertices, const Matrix3d& axes);

  /// The farthest point of a capsule from the hull [m]; negative where it lies within.
  double Beyond(const Shape& capsule) const;
  /// The same ahead and aside only, as seen along `toward` (unit): behind it is the finger.
  double BeyondAhead(const Shape& capsule, const Vector3d& toward) const;
  /// The hull's smallest width across `toward` (unit) [m].
  double WidthAcross(const Vector3d& toward) const;

 private:
  struct Direction {
    Vector3d d;
    double height = 0;  // of the hull
  };
  double Height(const Vector3d& d) const;
  void Add(const Vector3d& d) { directions_.push_back({d, Height(d)}); }

  const std::vector<Vector3d>& vertices_;
  std::vector<Direction> directions_;
};

}  // namespace regrasp
