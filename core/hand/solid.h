#pragma once

/// Mass properties of homogeneous solids, and whether a body can have those that a file claims.

#include <string>
#include <vector>

#include "core/common/frames.h"
#include "core/hand/hand_model.h"
#include "core/hand/mesh.h"
#include "core/hand/object_model.h"

namespace regrasp {

/// A homogeneous solid of density 1 kg/m³.
struct Solid {
  double volume = 0;                    ///< [m³]
  Vector3d centre = Vector3d::Zero();   ///< centre of mass [m]
  Matrix3d inertia = Matrix3d::Zero();  ///< about the centre of mass, at density 1 [kg m²]
};

Solid SphereSolid(double radius);
Solid BoxSolid(const Vector3d& half_extents);
/// Along z: all points within `radius` of a segment of twice `half_length`.
Solid CapsuleSolid(double radius, double half_length);
/// Of a closed mesh: the sum over signed tetrahedra from the origin [Tonon 2004]. Volume where
/// closed pieces overlap counts once for each.
Solid MeshSolid(const TriangleMesh& mesh);
/// Of closed pieces that may overlap, each place counted once: MeshSolid, unless more than 0.4 % of
/// the volume is in several pieces. Then inside is where more surfaces have been entered than left
/// [nonzero winding], along columns parallel to z, 160 across the larger side: within 0.2 % of the
/// volume. `overlap`, where given, becomes the volume that MeshSolid counts too often [m³], or 0.
Solid PiecesSolid(const TriangleMesh& mesh, double* overlap = nullptr);
/// Of an object's shape, in the object's frame.
Solid ObjectSolid(const ObjectModel& object);
/// Of several shapes of a link together, in the link frame; overlaps count twice.
Solid LinkSolid(const std::vector<Shape>& shapes);

/// The inertia of a point mass at `p`, about the origin.
Matrix3d PointInertia(double mass, const Vector3d& p);

/// The least first.
Vector3d PrincipalMoments(const Matrix3d& inertia);

/// Why no body can have this inertia, or "": three principal moments > 0, none above the sum of the
/// others (within 0.1 %: a rounded number may miss equality by its last digit).
std::string WhyNoInertia(const Matrix3d& inertia);

/// Densities that an object may have [kg/m³]: foam is 10 to 30, osmium 22 600.
inline constexpr double kLeastDensity = 10, kMostDensity = 25000;

/// "1222 kg/m³": four digits or more, never a power of ten.
std::string DensityText(double density);

/// Why this object cannot be; nothing where it can. `changed_by_shape`: computing centre and
/// inertia from the shape mends it.
struct Impossible {
  std::string why;
  bool changed_by_shape = true;
};
/// The rules: density, largest moment above m R² (R: farthest surface point
/// from the centre of mass), centre of mass outside the convex hull.
std::vector<Impossible> WhyNoBody(const ObjectModel& object);

/// Why this object is hardly like that, or "": a principal moment below a tenth of a homogeneous
/// body's of this shape and mass. A heavy core may be the reason, so that it is no error.
std::string WhyUnlikely(const ObjectModel& object);

}  // namespace regrasp
