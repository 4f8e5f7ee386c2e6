#include "core/posture/palm_frame.h"

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr double kOneSided = 0.2;  // of a range: so much more to one side is where a joint bends to

/// Where the tip goes as the two outer joints bend, each towards the larger end of its range.
Vector3d Bending(const HandAtRest& hand, const FingerChain& chain) {
  Vector3d way = Vector3d::Zero();
  const std::size_t n = chain.joints.size();
  for (std::size_t k = n > 2 ? n - 2 : 0; k < n; ++k) {
    const UrdfJoint& j = hand.joint(chain.joints[k]);
    const double more = std::abs(j.upper) - std::abs(j.lower);
    if (std::abs(more) < kOneSided * (j.upper - j.lower) || !(j.lower < j.upper)) continue;
    const Isometry3d& X = hand.pose(j.child);
    Vector3d arm = chain.p_tip - X.translation();
    if (arm.norm() < 5e-3) arm = X.translation() - chain.p_base;
    way += (more > 0 ? 1.0 : -1.0) * (X.linear() * j.axis).cross(arm);
  }
  return way;
}

}  // namespace

Isometry3d PalmFrame(const HandAtRest& hand, const std::vector<FingerChain>& chains) {
  Vector3d along = Vector3d::Zero(), base = Vector3d::Zero(), tips = Vector3d::Zero();
  for (const FingerChain& c : chains) {
    const Vector3d reach = c.reach();
    if (reach.norm() > 1e-6) along += reach.normalized();
    base += c.p_base / static_cast<double>(chains.size());
    tips += c.p_tip / static_cast<double>(chains.size());
  }
  if (along.norm() < 0.2 * static_cast<double>(chains.size())) along = tips - base;
  if (along.norm() < 1e-6) along = Vector3d::UnitZ();
  const Vector3d z = along.normalized();
  Vector3d bend = Vector3d::Zero(), strongest = Vector3d::Zero();
  double sum = 0;
  for (const FingerChain& c : chains) {
    const Vector3d way = TangentPart(Bending(hand, c), z);
    bend += way;
    sum += way.norm();
    if (way.norm() > strongest.norm()) strongest = way;
  }
  if (bend.norm() < 0.2 * sum) bend = strongest;  // fingers around a centre
  if (bend.norm() < 1e-6) bend = RotationFromZ(z).col(0);
  const Vector3d y = -bend.normalized();
  Isometry3d X_HR = Isometry3d::Identity();
  X_HR.linear().row(0) = y.cross(z).transpose();
  X_HR.linear().row(1) = y.transpose();
  X_HR.linear().row(2) = z.transpose();
  X_HR.translation() = -(X_HR.linear() * base);
  return X_HR;
}

}  // namespace regrasp
