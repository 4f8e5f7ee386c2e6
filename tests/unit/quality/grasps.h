#pragma once

/// Grasps for the tests of core/quality.

#include <cmath>
#include <vector>

#include "core/common/random.h"
#include "core/quality/grasp.h"

namespace regrasp::test {

using Contacts = std::vector<GraspContact>;

/// Contacts at the directions p on a sphere of radius R about the origin, normals to the centre.
inline Contacts OnSphere(const std::vector<Vector3d>& directions, double R, double mu) {
  Contacts contacts;
  for (const Vector3d& p : directions)
    contacts.push_back({R * p.normalized(), -p.normalized(), mu});
  return contacts;
}

inline Contacts Ring(int n, double R, double mu) {
  std::vector<Vector3d> p;
  for (int k = 0; k < n; ++k)
    p.emplace_back(std::cos(2 * M_PI * k / n), std::sin(2 * M_PI * k / n), 0);
  return OnSphere(p, R, mu);
}

inline Contacts Tetrahedron(double R, double mu) {
  return OnSphere({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, R, mu);
}

/// Frictionless contacts on a cube, two per face, whose wrenches are the corners of three squares
/// (f_x, t_y), (f_y, t_z), (f_z, t_x) = (+-1, +-1). Their hull is the free sum of the squares: its
/// polar is the product of three diamonds, so epsilon = 1 / sqrt(3); its volume is 4^3 * 2! 2! 2! /
/// 6!. With torques divided by R.
inline Contacts Cube(double R) {
  Contacts contacts;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      for (const double offset : {1.0, -1.0}) {
        const Vector3d normal = -side * Vector3d::Unit(axis);
        const Vector3d lever = offset * Vector3d::Unit((axis + 2) % 3);
        contacts.push_back({R * (side * Vector3d::Unit(axis) + lever), normal, 0.0});
      }
    }
  }
  return contacts;
}

/// n contacts anywhere on a sphere of 25 mm, normals about 10 degrees off, mu 0.3 ... 0.9. `bias`
/// moves them to that side.
inline Contacts Random(RandomStream& random, int n, const Vector3d& bias = Vector3d::Zero()) {
  Contacts contacts;
  for (int k = 0; k < n; ++k) {
    const Vector3d p = (random.Normal3() + bias).normalized();
    const Vector3d normal = (-p + 0.1 * random.Normal3()).normalized();
    contacts.push_back({0.025 * p, normal, 0.3 + 0.6 * random.Uniform()});
  }
  return contacts;
}

inline Matrix3d RandomRotation(RandomStream& random) {
  const Vector3d axis = random.Normal3().normalized();
  return Eigen::AngleAxisd(6.0 * random.Uniform(), axis).toRotationMatrix();
}

inline Contacts Rotated(const Contacts& contacts, const Matrix3d& R) {
  Contacts out;
  for (const GraspContact& c : contacts) out.push_back({R * c.position, R * c.inward_normal, c.mu});
  return out;
}

}  // namespace regrasp::test
