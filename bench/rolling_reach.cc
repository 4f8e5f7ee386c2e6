#include "bench/rolling_reach.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/hand/damped_inverse.h"

namespace regrasp {
namespace {

constexpr int kStepsPerSegment = 10;
constexpr double kDamping = 1e-9;       // of the inverse [m²]
constexpr double kMissing = 0.02;       // of a step: the finger does not follow
constexpr double kRedundantRate = 3.0;  // of the redundant motion, per turn of the ball [rad/rad]
constexpr double kLeastPush = 1e-3;     // what is left of a push by less is none

/// One way of a finger of its own: joint `joint` (of the finger) forwards or back, as far as its
/// contact does not care.
struct Push {
  Eigen::Index joint = 0;
  double sense = 0;
};

class Rolling {
 public:
  Rolling(const HandModel& hand, int finger, const JointVector& q, const Ball& ball,
          const BallWay& way)
      : hand_(hand), finger_(finger), q_(q), ball_(ball), way_(way) {
    start_ = PostureAt(hand, finger, AnglesOf(hand, finger, q));
    distance_ = (Core(start_, ball.p_WO) - ball.p_WO).norm();
    const auto joints = static_cast<Eigen::Index>(hand.fingers[finger].joints.size());
    pushes_.push_back({});
    if (joints > 2) AddPush(joints - 1);
    if (joints > 4) AddPush(0);
  }
  RollingEnd Farthest() {
    best_.angle = -1;
    Search(start_, 0);
    return best_;
  }

 private:
  static constexpr int kSteps = kRollingSegments * kStepsPerSegment;
  static constexpr Eigen::Index kNone = -1;

  void AddPush(Eigen::Index joint) {
    pushes_.push_back({joint, 1});
    pushes_.push_back({joint, -1});
  }
  /// The point of the tip's core (a segment, or the tip's centre) that is nearest to `p`.
  static Vector3d Core(const FingerPosture& posture, const Vector3d& p) {
    if (posture.tip.radius <= 0) return posture.p_WF;
    const Vector3d d = posture.tip.b_W - posture.tip.a_W;
    const double length = d.squaredNorm();
    const double s = length > 0 ? (p - posture.tip.a_W).dot(d) / length : 0.0;
    return posture.tip.a_W + std::clamp(s, 0.0, 1.0) * d;
  }
  /// Depth first through the sequences; ends where one goes the whole way.
  void Search(const FingerPosture& from, int segment) {
    for (const Push& push : pushes_) {
      if (best_.joint < 0 && best_.angle >= 0) return;
      FingerPosture posture = from;
      int step = segment * kStepsPerSegment, joint = -1;
      const int end = step + kStepsPerSegment;
      for (; step < end; ++step) {
        joint = Step(step, push, &posture);
        if (joint >= 0) break;
      }
      if (joint >= 0 || end == kSteps) {
        const double angle = way_.angle * step / kSteps;
        if (angle > best_.angle) best_ = {angle, joint};
      } else {
        Search(posture, segment + 1);
      }
    }
  }
  /// The joint that ends it, or -1.
  int Step(int step, const Push& push, FingerPosture* posture) const {
    // It shifts and turns aside first.
    const double before = std::min(1.0, static_cast<double>(step) / kStepsPerSegment);
    const double off = before < 1 ? 1.0 / kStepsPerSegment : 0.0;
    const Vector3d p_WO = ball_.p_WO + before * way_.shift_W;
    const Vector3d core = Core(*posture, p_WO);
    const Vector3d out = core - p_WO, n = out.normalized();
    const Vector3d r = ball_.radius * n;  // the contact, from the ball's centre
    const Vector3d turn = way_.angle / kSteps * way_.axis_W + off * way_.aside_W;
    const Vector3d dp = off * way_.shift_W + turn.cross(r) + (distance_ - out.norm()) * n;
    const FingerJacobian J = ContactJacobian(*posture, p_WO + r);
    FingerVector dq;
    if (!Solve(J, posture->q, dp, push, kNone, &dq) && !Solve(J, posture->q, dp, {}, kNone, &dq))
      return Binding(J, posture->q, dp);
    *posture = PostureAt(hand_, finger_, posture->q + dq);
    return -1;
  }
  /// How the joints move the point `p_WC` of the tip link [m/rad].
  FingerJacobian ContactJacobian(const FingerPosture& posture, const Vector3d& p_WC) const {
    JointVector q = q_;
    const auto& joints = hand_.fingers[finger_].joints;
    for (std::size_t k = 0; k < joints.size(); ++k)
      q[joints[k]] = posture.q[static_cast<Eigen::Index>(k)];
    KinematicsData data;
    ForwardKinematics(hand_, q, &data);
    return PointJacobian(hand_, data, finger_, p_WC);
  }
  /// The joint without whose limit the step could be made.
  int Binding(const FingerJacobian& J, const FingerVector& q, const Vector3d& dp) const {
    const auto& joints = hand_.fingers[finger_].joints;
    FingerVector dq;
    for (std::size_t k = 0; k < joints.size(); ++k)
      if (Solve(J, q, dp, {}, static_cast<Eigen::Index>(k), &dq)) return joints[k];
    return joints.front();
  }
  /// J dq = dp, the least such motion within the joint limits but that of `limitless`, with the
  /// push where the contact does not care. Whether there is one.
  bool Solve(FingerJacobian J, const FingerVector& q, Vector3d dp, const Push& push,
             Eigen::Index limitless, FingerVector* dq) const {
    const auto& joints = hand_.fingers[finger_].joints;
    const double way = dp.norm();
    FixedVector<Eigen::Index, kMaxFingerJoints> fixed;
    const auto is_fixed = [&](Eigen::Index k) {
      return std::ranges::find(fixed, k) != fixed.end();
    };
    FingerVector at_limits = FingerVector::Zero(q.size());
    for (;;) {
      const Matrix3d inverse = DampedInverse(J, kDamping);
      *dq = J.transpose() * (inverse * dp);
      if (push.sense != 0 && !is_fixed(push.joint)) {
        FingerVector u = -J.transpose() * (inverse * J.col(push.joint));
        u[push.joint] += 1;
        const double norm = u.norm();
        if (norm > kLeastPush) *dq += push.sense * kRedundantRate * way_.angle / kSteps / norm * u;
      }
      if ((dp - J * *dq).norm() > kMissing * way) return false;
      // The joint that would go farthest beyond its limit stays there. One that begins beyond it
      // may stay where it is.
      Eigen::Index worst = kNone;
      double most = 1e-12, to = 0;
      for (Eigen::Index k = 0; k < q.size(); ++k) {
        if (k == limitless || is_fixed(k)) continue;
        const Joint& joint = hand_.joints[joints[static_cast<std::size_t>(k)]];
        const double lower = std::min(joint.lower, q[k]), upper = std::max(joint.upper, q[k]);
        const double at = q[k] + (*dq)[k], over = std::max(at - upper, lower - at);
        if (over <= most) continue;
        worst = k;
        most = over;
        to = (at > upper ? upper : lower) - q[k];
      }
      if (worst == kNone) {
        *dq += at_limits;
        return true;
      }
      fixed.push_back(worst);
      at_limits[worst] = to;
      dp -= J.col(worst) * to;
      J.col(worst).setZero();
    }
  }

  const HandModel& hand_;
  int finger_;
  JointVector q_;  // of the whole hand where it begins [rad]
  Ball ball_;
  BallWay way_;
  FingerPosture start_;
  double distance_ = 0;  // of the core from the ball's centre, kept [m]
  std::vector<Push> pushes_;
  RollingEnd best_;
};

}  // namespace

RollingEnd FarthestRolling(const HandModel& hand, int finger, const JointVector& q,
                           const Ball& ball, const BallWay& way) {
  return Rolling(hand, finger, q, ball, way).Farthest();
}

RollingReach FarthestTurn(const HandModel& hand, const std::vector<int>& fingers,
                          const JointVector& q, const Ball& ball, const Vector3d& axis_W,
                          double most, const Allowance& allowance) {
  std::vector<Vector3d> shifts, asides;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        shifts.push_back(Vector3d(x, y, z).normalized() * allowance.shift);
  const Vector3d across = axis_W.unitOrthogonal(), other = axis_W.cross(across);
  asides.push_back(Vector3d::Zero());
  for (int k = 0; k < 8; ++k)
    asides.push_back(allowance.aside *
                     (std::cos(k * M_PI / 4) * across + std::sin(k * M_PI / 4) * other));
  RollingReach reach;
  reach.angle = -1;
  std::vector<RollingEnd> alone(fingers.size(), {-1, -1});
  for (const Vector3d& shift : shifts)
    for (const Vector3d& aside : asides) {
      RollingReach here;
      here.angle = most;
      for (std::size_t i = 0; i < fingers.size(); ++i) {
        const RollingEnd end =
            FarthestRolling(hand, fingers[i], q, ball, {axis_W, most, shift, aside});
        if (end.angle > alone[i].angle) alone[i] = end;
        if (end.joint >= 0 && end.angle < here.angle) {
          here.angle = end.angle;
          here.finger = fingers[i];
          here.joint = end.joint;
        }
      }
      if (here.angle <= reach.angle) continue;
      here.shift_W = shift;
      here.aside_W = aside;
      reach = here;
      if (reach.joint >= 0) continue;
      reach.alone.assign(fingers.size(), {most, -1});
      return reach;
    }
  reach.alone = alone;
  return reach;
}

}  // namespace regrasp
