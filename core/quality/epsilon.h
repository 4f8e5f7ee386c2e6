#pragma once

/// Ferrari-Canny epsilon (L1) [Ferrari, Canny 1992] and the volume of the grasp wrench space.

#include <cstddef>
#include <memory>
#include <span>

#include "core/quality/grasp.h"

namespace regrasp {

/// Radius of the largest ball about the origin inside the convex hull of all primitive wrenches. A
/// primitive force is n + mu (cos a t1 + sin a t2), a = 2 pi j / edges; torques are divided by
/// torque_scale. 0 where the origin is not inside (or inside by less than 1e-9).
///
/// Method: best-first partial hull. From seven points on, the facet nearest to the origin (signed:
/// facets that do not yet enclose the origin come first) grows by the point farthest beyond it;
/// when nothing lies beyond, its distance is the answer. Facets far from the origin are never
/// refined, which is what makes it some hundred times faster than the whole hull. Exact to 1e-9;
/// where points miss a common plane by so little that rounding breaks the hull, it is built again
/// with a coarser tolerance: exact to 1e-6.
///
/// In a tick, spread the work:
///
///   solver.Begin(grasp, scale, 8);          // copies the grasp
///   if (solver.Step(200)) use(solver.result());   // once a tick, until it returns true
///
/// How the work is divided never changes the result. Neither Begin() nor Step() nor Compute()
/// allocates for up to kMaxFingers contacts with 8 edges; larger problems allocate in Begin().
class EpsilonSolver {
 public:
  EpsilonSolver();
  ~EpsilonSolver();
  EpsilonSolver(EpsilonSolver&&) noexcept;
  EpsilonSolver& operator=(EpsilonSolver&&) noexcept;

  /// torque_scale: [m], > 0; edges: >= 3; contacts * edges <= 65535.
  double Compute(std::span<const GraspContact> contacts, double torque_scale, int edges);

  /// Starts a computation; one under way is dropped.
  void Begin(std::span<const GraspContact> contacts, double torque_scale, int edges);
  /// Goes on until at least `max_facets` facets have been made (about 0.2 us each; a step
  /// overshoots by one insertion, at most some 250 facets for 64 wrenches). True when the result is
  /// there, and from then on.
  bool Step(int max_facets);
  /// True before the first Begin() too, with result 0.
  bool done() const;
  /// Epsilon of the grasp given to Begin(); only once done().
  double result() const;
  /// At any time: epsilon is at least this. Where no tolerance yields a hull, the result is this
  /// bound; exact() is then false.
  double lower_bound() const;
  bool exact() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Volume of that hull (6-D). Slow (about 1 ms for 5 contacts with 8 edges, 5 ms with 16, 250 ms
/// with 64); allocates. 0 for a degenerate hull. Throws std::length_error for more than
/// kMaxHullWrenches primitive wrenches, std::runtime_error where rounding defeats every tolerance
/// (no case known).
double WrenchHullVolume(std::span<const GraspContact> contacts, double torque_scale, int edges);

inline constexpr std::size_t kMaxHullWrenches =
    400;  ///< bounds memory (300 MB) and time (1 s) of the volume

}  // namespace regrasp
