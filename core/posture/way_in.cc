#include "core/posture/way_in.h"

#include <algorithm>
#include <cmath>

namespace regrasp {
namespace {

constexpr double kDepth = 0.0075;   // reaches into one 15 mm smaller across [m]
constexpr double kLittle = 0.0025;  // ... 5 mm, where a fingertip slips past the ball [m]
constexpr double kClear = 0.005;    // wanted gap of links [m]
constexpr int kTrials = 300;        // directions per finger
constexpr double kStep = 0.02;      // [rad]

/// Searches one finger's straight line in joint space through its joints in `grasp`; the best goes
/// into `open` and `closed`, which is `depth` inside the ball. False where there is none.
bool FindLine(const HandModel& hand, const BallGrasp& grasp, const BallTask& task, int f,
              double depth, RandomStream* random, JointVector* open, JointVector* closed) {
  const double radius = task.radius;
  const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
  KinematicsData data;
  ForwardKinematics(hand, grasp.q, &data);
  const Vector3d tip = FingertipCentre(hand, data, f);
  const Vector3d touch = (tip - grasp.p_WO).normalized();
  const FingerJacobian J = PointJacobian(hand, data, f, tip);
  const FingerVector radial =
      J.transpose() * (J * J.transpose() + 1e-5 * Matrix3d::Identity()).inverse() * touch;
  double best = -1e9;
  for (int trial = 0; trial < kTrials; ++trial) {
    FingerVector direction = radial.normalized();
    if (trial > 0)
      for (Eigen::Index k = 0; k < direction.size(); ++k) direction[k] += 0.4 * random->Normal();
    direction.normalize();
    // Along the line from the grasp until the tip is `until` from the surface; false at a limit.
    const auto Go = [&](double sign, double until, JointVector* q) {
      for (int k = 0; k < 80; ++k) {
        ForwardKinematics(hand, *q, &data);
        const double off =
            (FingertipCentre(hand, data, f) - grasp.p_WO).norm() - radius - finger.tip_radius;
        if (sign * off >= sign * until) return true;
        for (std::size_t n = 0; n < finger.joints.size(); ++n) {
          const Joint& joint = hand.joints[static_cast<std::size_t>(finger.joints[n])];
          double& angle = (*q)[finger.joints[n]];
          angle += sign * kStep * direction[static_cast<Eigen::Index>(n)];
          if (angle < joint.lower || angle > joint.upper) return false;
        }
      }
      return false;
    };
    JointVector out = *open, in = *closed;
    for (int j : finger.joints) out[j] = in[j] = grasp.q[j];
    if (!Go(-1, -depth, &in) || !Go(1, task.gap, &out)) continue;
    double margin = 1, length = 0;
    for (int j : finger.joints) {
      const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
      for (double q : {out[j], in[j]})
        margin = std::min({margin, q - joint.lower, joint.upper - q});
      length = std::hypot(length, out[j] - in[j]);
    }
    ForwardKinematics(hand, out, &data);
    const double drift =
        ((FingertipCentre(hand, data, f) - grasp.p_WO).normalized() - touch).norm();
    double score = 2 * std::min(margin, 0.1) / 0.1 - drift / 0.3 - 0.3 * length;
    if (score <= best) continue;
    score += std::min(0.0, (Clearance(hand, data, grasp.p_WO, radius) - kClear) / 0.001);
    if (score <= best) continue;
    best = score;
    *open = out;
    *closed = in;
  }
  return best > -1e9;
}

/// Smallest gap between links while all fingers close from `open` to `closed`, each until it
/// touches a ball of `radius`; `landed` gets the posture in which all touch.
double GapOnTheWay(const HandModel& hand, const WayIn& way, const Vector3d& p_WO, double radius,
                   JointVector* landed) {
  constexpr int kSteps = 40;
  KinematicsData data;
  double gap = 1e9;
  *landed = way.open;
  for (int k = 0; k <= kSteps; ++k) {
    ForwardKinematics(hand, *landed, &data);
    gap = std::min(gap, Clearance(hand, data, p_WO, 0.5 * radius));
    for (int f = 0; f < hand.num_fingers(); ++f) {
      const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
      if ((FingertipCentre(hand, data, f) - p_WO).norm() < radius + finger.tip_radius) continue;
      for (int j : finger.joints)
        (*landed)[j] = way.open[j] + (way.closed[j] - way.open[j]) * k / kSteps;
    }
  }
  return gap;
}

}  // namespace

WayIn FindWayIn(const HandModel& hand, const BallTask& task, const BallGrasp& grasp, int attempts,
                RandomStream* random) {
  WayIn best;
  double best_score = -1e18;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    WayIn way;
    way.open = way.closed = grasp.q;
    for (int f = 0; f < hand.num_fingers(); ++f)
      if (!FindLine(hand, grasp, task, f, kDepth, random, &way.open, &way.closed) &&
          !FindLine(hand, grasp, task, f, kLittle, random, &way.open, &way.closed))
        way.stuck = f;
    way.gap = 1e9;
    double score = way.stuck >= 0 ? -1e6 : 0;
    for (double change : {0.005, -0.0025}) {
      BallTask other = task;
      other.radius += change;
      BallGrasp landed = grasp;
      way.gap = std::min(way.gap, GapOnTheWay(hand, way, grasp.p_WO, other.radius, &landed.q));
      RateGrasp(hand, other, -1e9, &landed);
      score += landed.score;
    }
    score += std::min(0.0, (way.gap - kClear) / 0.001);
    if (score <= best_score) continue;
    best_score = score;
    best = way;
  }
  return best;
}

}  // namespace regrasp
