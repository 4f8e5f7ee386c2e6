#pragma once

/// A convex hull in the six dimensions of wrenches, built only as far as a question about it needs.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/quality/grasp.h"

namespace regrasp {

using Wrench = Eigen::Matrix<double, 6, 1>;  ///< force over torque / torque_scale

/// Appends the primitive wrenches of a grasp to `out`: n + mu (cos a t1 + sin a t2), a = 2 pi j /
/// edges, over its torque divided by torque_scale; `edges` per contact, in order; of a soft finger
/// two more, n with the largest moment about n in either sense. Allocates only when `out` has to
/// grow.
void AppendPrimitiveWrenches(std::span<const GraspContact> contacts, double torque_scale, int edges,
                             std::vector<Wrench>& out);

/// The hull of a growing subset of given points, as a closed complex of simplicial facets. Insert()
/// adds the point farthest beyond one facet [Barber, Dobkin, Huhdanpaa 1996: quickhull]; which
/// facet is the caller's choice, so that a search may stay near the origin. As every intermediate
/// polytope lies inside the hull of all points, its least facet offset is a lower bound of the
/// hull's; it is exact once no point lies beyond that facet.
///
/// New planes come from the two planes that meet in the horizon ridge (the one plane of their
/// pencil that contains the new point), 7 multiplications each, without solving for a normal.
/// Points within a tolerance of a plane count as inside, so coplanar and repeated points need no
/// special case. Each point is inserted at most once: every loop ends. All memory is kept between
/// hulls.
class WrenchHull {
 public:
  /// Makes room for hulls of this many points and at most `facets` facets at a time: Start() and
  /// Insert() never allocate within it, and Insert() fails beyond it. Allocates what is missing;
  /// about 300 bytes a facet.
  void Reserve(std::size_t points, std::size_t facets);

  /// Starts from a large simplex of seven of the points (a view of which is kept until the next
  /// Start()). False where the points do not span six dimensions. At most 65535 points, as
  /// reserved. tolerance: of the largest wrench; points nearer to a plane count as on it. Offsets
  /// are wrong by no more than that.
  bool Start(std::span<const Wrench> points, double tolerance = kTolerances[0]);

  /// To try one after the other: a hull fails only where points miss a common plane by about the
  /// tolerance.
  static constexpr std::array<double, 3> kTolerances = {1e-10, 1e-8, 1e-7};

  /// The open facet with the least offset; an open facet may have points beyond it. -1 where none
  /// is open.
  int NearestOpen() const;
  /// Signed distance of the origin behind the facet's plane; negative where the origin is outside.
  double Offset(int facet) const { return facets_[facet].offset; }

  enum class Growth {
    kGrown,   ///< the farthest point beyond the facet was added
    kClosed,  ///< no point lies beyond: a facet of the hull of all points
    kFailed,  ///< out of room, or rounding broke the complex; start again or give up
  };
  Growth Insert(int facet);
  /// Inserts until no facet is open: the hull of all points. False on failure.
  bool Complete();

  /// Volume of the polytope built so far.
  double Volume() const;

  /// Facets made since Start(): the measure of the work done.
  std::size_t facets_built() const { return facets_built_; }

 private:
  struct Facet {
    Wrench normal;  // unit, outward
    double offset;
    double height;  // of the point being inserted; valid where mark == visit_
    std::array<std::int32_t, 6> neighbour;  // across the ridge without vertex[k]
    std::array<std::uint16_t, 6> vertex;
    std::uint32_t mark;
  };
  struct Seam {             // a ridge of the new point waiting for its second facet
    std::uint64_t key = 0;  // its four other vertices
    std::uint32_t mark = 0;
    std::int32_t place = 0;  // 8 * facet + slot; -1 once joined
  };

  int NewFacet();
  bool Join(std::span<const std::int32_t> facets);

  std::span<const Wrench> points_;
  double tolerance_ = 0.0;
  std::vector<char> inserted_;
  std::vector<Facet> facets_;
  std::vector<double> key_;  // offset of an open facet, else infinity
  std::vector<std::int32_t> free_, visible_, fresh_;
  std::vector<Seam> seams_;
  std::uint32_t visit_ = 0, seam_visit_ = 0;
  std::size_t facet_limit_ = 0, facets_built_ = 0;
  Wrench inside_ = Wrench::Zero();
};

}  // namespace regrasp
