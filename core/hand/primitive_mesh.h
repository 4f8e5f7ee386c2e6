#pragma once

/// Boxes, spheres, cylinders and capsules as closed triangle meshes, for objects made of several of
/// them.

#include "core/hand/mesh.h"

namespace regrasp {

/// A facet lies at most so far from the round surface it stands for [m]: corners half of it
/// outside, middles half of it inside.
inline constexpr double kFacet = 3e-5;

/// `size` along x, y, z about the origin [m].
TriangleMesh BoxMesh(const Vector3d& size);
/// About the z axis, from -half_length to half_length [m].
TriangleMesh CylinderMesh(double radius, double half_length);
/// All points within `radius` of the segment of twice `half_length` along z [m]; a sphere where
/// that is 0.
TriangleMesh CapsuleMesh(double radius, double half_length);

}  // namespace regrasp
