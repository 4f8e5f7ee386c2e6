#pragma once

/// Shapes fitted to meshes: the simulation knows capsules and boxes only, because its contacts of
/// round links are exact and smooth.

#include <optional>
#include <string>

#include "core/common/frames.h"
#include "core/hand/hand_model.h"
#include "core/hand/mesh.h"

namespace regrasp {

struct FittedShape {
  Shape shape;
  std::string kind;    ///< "sphere", "capsule" or "box"
  double error_m = 0;  ///< largest distance of a point of the mesh from the shape's surface
  double rms_m = 0;
  bool within = false;  ///< a fingertip that no round end meets
};

/// A fingertip within this error has contacts as those of its mesh [m]; beyond it is said.
inline constexpr double kGoodFit = 1e-3;

/// The capsule or box that comes nearest to all of the surface, in the mesh's frame. Least squares
/// of the distance over points spread evenly over the surface; deterministic.
FittedShape FitShape(const TriangleMesh& mesh);

/// The capsule or sphere nearest to the rounded end that lies farthest along `toward` (unit): the
/// part of the convex hull within one half-width of the end, which is what touches objects. The
/// errors are of that part. It is thicker than the link by no more than 35 %, sticks out of the
/// hull ahead and aside by no more than kGoodFit or its error, and leaves out no more than its
/// radius unless the part that touches is met within kGoodFit. Where no such one is found (a
/// plate), the capsule within the hull, as thick as the link; its error is that of all of the
/// surface, both ways. The end of the capsule that makes the tip is b_L.
FittedShape FitFingertip(const TriangleMesh& mesh, const Vector3d& toward);

}  // namespace regrasp
