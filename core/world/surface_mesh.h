#pragma once

/// Closest point of a closed triangle mesh to a segment, for contacts of rounded links (capsules)
/// with a mesh object. ODE's own capsule-trimesh collider returned normals up to 18 degrees off on
/// a fine sphere and took 45 us; the exact closest point gives a normal that turns continuously as
/// the link moves.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "core/common/frames.h"

namespace regrasp {

class SurfaceMesh {
 public:
  /// Vertices in O [m]; triangles counter-clockwise seen from outside. At least one triangle.
  SurfaceMesh(const std::vector<Vector3d>& vertices_O,
              const std::vector<Eigen::Vector3i>& triangles);
  /// The same, shared with whoever uses the one of this mesh (LastMesh). Any thread.
  static std::shared_ptr<const SurfaceMesh> Shared(const std::vector<Vector3d>& vertices_O,
                                                   const std::vector<Eigen::Vector3i>& triangles);

  struct Closest {
    Vector3d p_OSegment = Vector3d::Zero();  ///< closest point of the segment [m]
    Vector3d p_OSurface = Vector3d::Zero();  ///< closest point of the surface [m]
    /// Out of the surface there: the normal of the triangle or, at an edge or a corner, the mean of
    /// those that meet in it, weighted by the angle that each takes up [Baerentzen and Aanaes
    /// 2005]. Only that mean tells which side of a sharp edge a point is on: triangles whose
    /// normals are more than 90 degrees apart do not agree.
    Vector3d outward_O = Vector3d::UnitZ();
    double distance = 0;  ///< between the two [m]
  };
  /// The closest pair of points of the surface and the segment a-b (a == b: a point), if nearer
  /// than `max_distance`. Exact and deterministic. Allocates nothing.
  std::optional<Closest> ClosestToSegment(const Vector3d& a_O, const Vector3d& b_O,
                                          double max_distance) const;

 private:
  struct Triangle {
    Vector3d v[3];
    Vector3d normal;
    Vector3d edge_normal[3], corner_normal[3];  // edge k runs from corner k to the next
    bool owns_edge[3] = {};
  };
  // A node of a tree of bounding spheres. A leaf holds triangles [first, first + count); an inner
  // node (count == 0) has its children at `first` and `first + 1`.
  struct Node {
    Vector3d centre = Vector3d::Zero();
    double radius = 0;
    int first = 0;
    int count = 0;
  };
  void Build(int node, int begin, int end);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace regrasp
