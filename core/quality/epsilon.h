#pragma once

/// Ferrari-Canny epsilon (L1) [Ferrari, Canny 1992] and the volume of the grasp wrench space.

#include <memory>
#include <span>

#include "core/quality/grasp.h"

namespace regrasp {

/// Radius of the largest ball about the origin inside the convex hull of all primitive wrenches. A
/// primitive force is n + mu (cos a t1 + sin a t2), a = 2 pi j / edges; torques are divided by
/// torque_scale. 0 where the origin is not inside. Exact (to rounding) by a best-first partial hull: only
/// the facets nearest to the origin are ever built. Memory is preallocated: Compute() does not allocate
/// for up to kMaxFingers contacts with 8 edges.
class EpsilonSolver {
 public:
  EpsilonSolver();
  ~EpsilonSolver();
  EpsilonSolver(EpsilonSolver&&) noexcept;
  EpsilonSolver& operator=(EpsilonSolver&&) noexcept;
  double Compute(std::span<const GraspContact> contacts, double torque_scale, int edges);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Volume of that hull (6-D). Slow (milliseconds); may allocate. 0 for a degenerate hull.
double WrenchHullVolume(std::span<const GraspContact> contacts, double torque_scale, int edges);

/// True when the origin is strictly inside the hull of the primitive wrenches.
bool ForceClosure(std::span<const GraspContact> contacts, double torque_scale, int edges);

}  // namespace regrasp
