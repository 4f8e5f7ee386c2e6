#include "core/hand/finger_reach.h"

#include <algorithm>
#include <cmath>

#include "core/hand/damped_inverse.h"

namespace regrasp {
namespace {

constexpr double kClose = 2e-4;        // the tip is there [m]
constexpr double kLongestStep = 0.35;  // per joint and step [rad]

double Volume(const Shape& shape) {
  if (shape.kind == Shape::Kind::kBox) return 8 * shape.half_extents.prod();
  const double length = (shape.b_L - shape.a_L).norm();
  return M_PI * shape.radius * shape.radius * (length + 4.0 / 3.0 * shape.radius);
}

/// Of the largest shape from the `first` on; none where there is none.
Bones LargestOf(const Link& link, std::size_t first, const Isometry3d& X_WL) {
  const Shape* largest = nullptr;
  for (std::size_t s = first; s < link.shapes.size(); ++s)
    if (largest == nullptr || Volume(link.shapes[s]) > Volume(*largest)) largest = &link.shapes[s];
  return largest == nullptr ? Bones() : BonesOf(*largest, X_WL);
}

/// J⁺ x.
FingerVector Solve(const FingerJacobian& J, const Vector3d& x) {
  const Vector3d y = DampedInverse(J) * x;
  return J.transpose() * y;
}

/// One step of the tip by `dp`; joints drift to the middle of their range where the tip does not
/// care. Clamped `margin` inside the limits.
FingerVector Stepped(const HandModel& hand, int finger, const FingerPosture& posture,
                     const Vector3d& dp, double margin, double pull) {
  const auto& joints = hand.fingers[finger].joints;
  FingerVector dq = Solve(posture.J, dp);
  if (pull > 0) {
    FingerVector middle(posture.q.size());
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const Joint& joint = hand.joints[joints[k]];
      const auto i = static_cast<Eigen::Index>(k);
      middle[i] = pull * (0.5 * (joint.lower + joint.upper) - posture.q[i]);
    }
    const Vector3d moved = posture.J * middle;
    dq += middle - Solve(posture.J, moved);
  }
  FingerVector q = posture.q;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const Joint& joint = hand.joints[joints[k]];
    const auto i = static_cast<Eigen::Index>(k);
    const double low = std::min(joint.lower + margin, posture.q[i]);
    const double high = std::max(joint.upper - margin, posture.q[i]);
    q[i] = std::clamp(q[i] + std::clamp(dq[i], -kLongestStep, kLongestStep), low, high);
  }
  return q;
}

}  // namespace

Bones BonesOf(const Shape& shape, const Isometry3d& X_WL) {
  constexpr double kFlat = 5e-4;  // [m]
  Bones bones;
  if (shape.kind == Shape::Kind::kCapsule) {
    bones.push_back({X_WL * shape.a_L, X_WL * shape.b_L, shape.radius});
    return bones;
  }
  Eigen::Index along = 0, thin = 0;
  shape.half_extents.maxCoeff(&along);
  const double radius = shape.half_extents.minCoeff(&thin);
  if (along == thin) along = (thin + 1) % 3;  // a cube
  const Eigen::Index across = 3 - along - thin;
  const Isometry3d X_WB = X_WL * shape.X_LB;
  const Vector3d half = (shape.half_extents[along] - radius) * X_WB.linear().col(along);
  const double off = shape.half_extents[across] - radius;
  const Vector3d side = (off > kFlat ? off : 0.0) * X_WB.linear().col(across);
  const Vector3d& p = X_WB.translation();
  bones.push_back({p + side - half, p + side + half, radius});
  if (off > kFlat) bones.push_back({p - side - half, p - side + half, radius});
  return bones;
}

JointChain ChainOf(const HandModel& hand, int finger) {
  JointChain chain;
  for (int j = hand.links[hand.fingers[finger].tip_link].parent_joint; j >= 0;
       j = hand.links[hand.joints[j].parent_link].parent_joint)
    chain.push_back(j);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

FingerPosture PostureAt(const HandModel& hand, int finger, const FingerVector& q) {
  const Finger& model = hand.fingers[finger];
  FingerPosture posture;
  posture.q = q;
  const JointChain chain = ChainOf(hand, finger);
  struct Axis {
    Vector3d axis_W, p_WJ;
    double ratio;  // of the finger's joint `column`
    Eigen::Index column;
  };
  FixedVector<Axis, kMaxLinks> axes;
  Isometry3d X_WL = Isometry3d::Identity();
  for (std::size_t n = 0; n < chain.size(); ++n) {
    const Joint& joint = hand.joints[chain[n]];
    const int driven = joint.driver < 0 ? chain[n] : joint.driver;
    const auto column = static_cast<Eigen::Index>(
        std::find(model.joints.begin(), model.joints.end(), driven) - model.joints.begin());
    if (n > 0 && n + 1 == chain.size()) {
      posture.middle = LargestOf(hand.links[joint.parent_link], 0, X_WL);
      posture.X_WM = X_WL;
    }
    X_WL = X_WL * joint.X_PJ;
    axes.push_back({X_WL.linear() * joint.axis_J, X_WL.translation(), joint.ratio, column});
    const double angle = joint.driver < 0 ? q[column] : joint.ratio * q[column] + joint.offset;
    X_WL.linear() = X_WL.linear() * Eigen::AngleAxisd(angle, joint.axis_J).toRotationMatrix();
  }
  posture.X_WT = X_WL;
  posture.p_WF = X_WL * model.p_LF;
  posture.along_W = (posture.p_WF - X_WL.translation()).normalized();
  const Link& last = hand.links[model.tip_link];
  if (!last.shapes.empty()) posture.tip = BonesOf(last.shapes.front(), X_WL)[0];
  posture.body = LargestOf(last, 1, X_WL);
  posture.J = FingerJacobian::Zero(3, static_cast<Eigen::Index>(model.joints.size()));
  for (const Axis& axis : axes)
    posture.J.col(axis.column) += axis.ratio * axis.axis_W.cross(posture.p_WF - axis.p_WJ);
  return posture;
}

FingerVector AnglesOf(const HandModel& hand, int finger, const JointVector& q) {
  const auto& joints = hand.fingers[finger].joints;
  FingerVector angles(static_cast<Eigen::Index>(joints.size()));
  for (std::size_t k = 0; k < joints.size(); ++k)
    angles[static_cast<Eigen::Index>(k)] = q[joints[k]];
  return angles;
}

FingerPosture ReachFor(const HandModel& hand, int finger, const FingerPosture& from,
                       const Vector3d& p_WF, double margin, int steps, const ReachRule& rule) {
  FingerPosture posture = from;
  for (int i = 0; i < steps; ++i) {
    const Vector3d error = p_WF - posture.p_WF;
    if (error.squaredNorm() < kClose * kClose) break;
    posture = PostureAt(hand, finger,
                        Stepped(hand, finger, posture, error, margin, rule.middle_pull * 0.5));
  }
  return posture;
}

double MotionReserve(const HandModel& hand, int finger, const FingerPosture& from,
                     const Vector3d& p_WO, const Vector3d& axis_W, double margin, double most,
                     const ReachRule& rule) {
  if (axis_W.isZero(0)) return most;
  const auto& joints = hand.fingers[finger].joints;
  FingerPosture posture = from;
  Vector3d r = from.p_WF - p_WO;
  const Matrix3d turn = Eigen::AngleAxisd(kTurnStep, axis_W).toRotationMatrix();
  for (double angle = 0; angle < most; angle += kTurnStep) {
    r = turn * r;
    const FingerVector before = posture.q;
    posture = PostureAt(
        hand, finger,
        Stepped(hand, finger, posture, p_WO + r - posture.p_WF, -kLongestStep, rule.middle_pull));
    if ((p_WO + r - posture.p_WF).norm() > rule.tolerance) return angle;
    double share = 1;  // of this step, until the first joint comes too near to its limit
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const Joint& joint = hand.joints[joints[k]];
      const auto i = static_cast<Eigen::Index>(k);
      const double sense = posture.q[i] > from.q[i] ? 1 : -1;
      const double limit = sense > 0 ? joint.upper - margin : joint.lower + margin;
      const double over = sense * (posture.q[i] - limit);
      if (over <= 0) continue;
      const double moved = sense * (posture.q[i] - before[i]);
      share = std::min(share, moved > over ? 1 - over / moved : 0.0);
    }
    if (share < 1) return std::min(most, angle + share * kTurnStep);
  }
  return most;
}

double Gap(const Bone& one, const Bone& two) {
  if (one.radius <= 0 || two.radius <= 0) return 1.0;
  // Closest points of the two lines, held to one segment, then each end to the other: one pass
  // finds the segments' own [Ericson 2005, Sec. 5.1.9; points and parallels have no branch of their
  // own].
  const Vector3d d1 = one.b_W - one.a_W, d2 = two.b_W - two.a_W, r = one.a_W - two.a_W;
  const double a = std::max(1e-12, d1.squaredNorm()), e = std::max(1e-12, d2.squaredNorm());
  const double b = d1.dot(d2), c = d1.dot(r), f = d2.dot(r), denominator = a * e - b * b;
  double s = denominator > 1e-18 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  const double t = std::clamp((b * s + f) / e, 0.0, 1.0);
  s = std::clamp((b * t - c) / a, 0.0, 1.0);
  return (one.a_W + s * d1 - two.a_W - t * d2).norm() - one.radius - two.radius;
}

}  // namespace regrasp
