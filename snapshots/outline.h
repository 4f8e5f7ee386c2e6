#pragma once

/// The surface of an object as triangles, and lines that show its shape. Internal to snapshots/.

#include <vector>

#include "core/common/frames.h"
#include "core/hand/object_model.h"

namespace regrasp {

struct ObjectMesh {
  std::vector<Vector3d> vertices_O;        ///< [m]
  std::vector<Eigen::Vector3i> triangles;  ///< counter-clockwise seen from outside
};

/// A piece of a line on the surface, with the outward normals of the faces it belongs to: it can be
/// seen when one of them faces the viewer (exact for convex objects).
struct SurfaceLine {
  Vector3d a_O, b_O;  ///< [m]
  Vector3d n1_O, n2_O;
  bool FacesViewer(const Vector3d& to_viewer_O) const {
    return n1_O.dot(to_viewer_O) > 0 || n2_O.dot(to_viewer_O) > 0;
  }
};

/// The object's own triangles, or a fine tessellation of a sphere, capsule or box.
ObjectMesh MeshOf(const ObjectModel& object);

/// Sharp edges, and the cuts of the surface with five planes across z and four planes through the z
/// axis.
std::vector<SurfaceLine> ShapeLines(const ObjectMesh& mesh);

/// Edges between a face that faces a distant viewer and one that does not.
std::vector<SurfaceLine> Silhouette(const ObjectMesh& mesh, const Vector3d& to_viewer_O);

}  // namespace regrasp
