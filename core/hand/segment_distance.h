#pragma once

/// The closest points of two segments, exactly [Ericson 2005, Sec. 5.1.9].

#include <algorithm>

#include "core/common/frames.h"

namespace regrasp {

struct SegmentPoints {
  Vector3d on_one, on_two;
};

/// Of the segments a1-b1 and a2-b2 [m]. A segment shorter than 1 µm is the point where it begins;
/// of parallel ones that lie beside each other one of the closest pairs.
inline SegmentPoints ClosestOfSegments(const Vector3d& a1, const Vector3d& b1, const Vector3d& a2,
                                       const Vector3d& b2) {
  const Vector3d d1 = b1 - a1, d2 = b2 - a2, r = a1 - a2;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  double s = 0, t = 0;
  constexpr double kPoint = 1e-12;  // m²: shorter segments are points
  if (a <= kPoint && e <= kPoint) return {a1, a2};
  if (a <= kPoint) {
    t = std::clamp(f / e, 0.0, 1.0);
  } else {
    const double c = d1.dot(r);
    if (e <= kPoint) {
      s = std::clamp(-c / a, 0.0, 1.0);
    } else {
      const double b = d1.dot(d2), denominator = a * e - b * b;
      if (denominator > 1e-18) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
      t = (b * s + f) / e;
      if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = std::clamp((b * t - c) / a, 0.0, 1.0);
      }
    }
  }
  return {a1 + s * d1, a2 + t * d2};
}

}  // namespace regrasp
