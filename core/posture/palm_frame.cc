#include "core/posture/palm_frame.h"

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr double kOneSided = 0.2;  // of a range: so much more to one side is where a joint bends to

/// Where the tip goes as joint `j` turns towards its upper limit, per angle [m].
Vector3d Way(const HandAtRest& hand, const FingerChain& chain, int j) {
  const Isometry3d& X = hand.pose(hand.joint(j).child);
  Vector3d arm = chain.p_tip - X.translation();
  if (arm.norm() < 5e-3) arm = X.translation() - chain.p_base;
  return (X.linear() * hand.joint(j).axis).cross(arm);
}

/// 1 or -1: the end of its range that a joint bends to; 0 where both are about as far.
double Side(const UrdfJoint& j) {
  const double more = std::abs(j.upper) - std::abs(j.lower);
  if (std::abs(more) < kOneSided * (j.upper - j.lower) || !(j.lower < j.upper)) return 0;
  return more > 0 ? 1 : -1;
}

/// The outermost joint that moves the tip; -1 if none.
int OuterJoint(const HandAtRest& hand, const FingerChain& chain) {
  constexpr double kMoves = 2e-3;  // [m]
  for (auto j = chain.joints.rbegin(); j != chain.joints.rend(); ++j)
    if (Way(hand, chain, *j).norm() > kMoves) return *j;
  return -1;
}

/// Where the tip goes as the two outer joints bend, each towards the larger end of its range; where
/// theirs have none, as the next one does that turns about the same axis or nearly.
Vector3d Bending(const HandAtRest& hand, const FingerChain& chain) {
  constexpr double kSameAxis = 0.7;  // cosine; a finger's sideways joint is across
  Vector3d way = Vector3d::Zero();
  const std::size_t n = chain.joints.size();
  bool sided = false;
  for (std::size_t k = n > 2 ? n - 2 : 0; k < n; ++k) {
    const double side = Side(hand.joint(chain.joints[k]));
    sided = sided || side != 0;
    if (side != 0) way += side * Way(hand, chain, chain.joints[k]);
  }
  const int outer = OuterJoint(hand, chain);
  if (sided || outer < 0) return way;
  const auto axis = [&](int j) {
    return Vector3d(hand.pose(hand.joint(j).child).linear() * hand.joint(j).axis);
  };
  for (std::size_t k = n > 2 ? n - 2 : 0; k-- > 0;) {
    const int j = chain.joints[k];
    const double side = Side(hand.joint(j));
    if (side != 0 && std::abs(axis(j).dot(axis(outer))) > kSameAxis)
      return side * Way(hand, chain, j);
  }
  return way;
}

/// Where the tip goes as the outer joint bends towards the other fingers; where they lie to neither
/// side, towards its upper limit.
Vector3d Closing(const HandAtRest& hand, const std::vector<FingerChain>& chains,
                 const FingerChain& chain, const Vector3d& z) {
  constexpr double kBeside = 3e-3;  // [m]
  const int outer = OuterJoint(hand, chain);
  if (outer < 0) return Vector3d::Zero();
  const Vector3d way = TangentPart(Way(hand, chain, outer), z);
  Vector3d others = Vector3d::Zero();
  for (const FingerChain& c : chains)
    others += (c.p_tip - chain.p_tip) / static_cast<double>(chains.size() - 1);
  return others.dot(way) < -kBeside * way.norm() ? Vector3d(-way) : way;
}

/// The sum of what each finger says, or where they stand around a centre the largest of it; of
/// equals the first, which does not change as the file is turned.
Vector3d Together(const std::vector<Vector3d>& ways) {
  Vector3d sum = Vector3d::Zero(), strongest = Vector3d::Zero();
  double norms = 0;
  for (const Vector3d& way : ways) {
    sum += way;
    norms += way.norm();
    if (way.norm() > (1 + 1e-6) * strongest.norm()) strongest = way;
  }
  return sum.norm() < 0.2 * norms ? strongest : sum;
}

}  // namespace

Isometry3d PalmFrame(const HandAtRest& hand, const std::vector<FingerChain>& chains,
                     bool* guessed) {
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
  std::vector<Vector3d> bending, closing;
  for (const FingerChain& c : chains) {
    bending.push_back(TangentPart(Bending(hand, c), z));
    closing.push_back(Closing(hand, chains, c, z));
  }
  Vector3d bend = Together(bending);
  *guessed = bend.norm() < 1e-6;
  if (*guessed) bend = Together(closing);
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
