#include "core/posture/ball_grasp.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/hand/segment_distance.h"
#include "core/quality/load_margin.h"
#include "core/quality/manipulability.h"

namespace regrasp {
namespace {

constexpr double kTouched = 1e-5;      // [m]
constexpr double kClear = 0.005;       // wanted gap of links [m]
constexpr double kPalmGap = 0.004;     // ... and so much more of the ball to the palm [m]
constexpr double kClimbReach = 0.005;  // [m]
constexpr double kFacing = 0.2;        // wanted cosine of a tip's axis to the ball
constexpr double kPush = 0.75;         // wanted share of a tip's motion along its contact's normal
constexpr double kMostOfMargins = 6, kMostOfClimb = 1.5;  // of the score

void Clamp(const HandModel& hand, int joint, double* angle) {
  const Joint& j = hand.joints[static_cast<std::size_t>(joint)];
  *angle = std::clamp(*angle, j.lower, j.upper);
}

/// A shape as a capsule: a box becomes the one along its longest side.
Shape AsCapsule(const Shape& shape) {
  if (shape.kind == Shape::Kind::kCapsule) return shape;
  Eigen::Index axis = 0;
  shape.half_extents.maxCoeff(&axis);
  Shape capsule;
  capsule.radius = 0.5 * (shape.half_extents.sum() - shape.half_extents[axis]);
  const double half = std::max(0.0, shape.half_extents[axis] - capsule.radius);
  capsule.a_L = shape.X_LB * Vector3d(-half * Vector3d::Unit(axis));
  capsule.b_L = shape.X_LB * Vector3d(half * Vector3d::Unit(axis));
  return capsule;
}

double PointToSegment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double len = d.squaredNorm();
  const double t = len > 0 ? std::clamp((p - a).dot(d) / len, 0.0, 1.0) : 0.0;
  return (p - a - t * d).norm();
}

double SegmentDistance(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                       const Vector3d& b1) {
  const SegmentPoints closest = ClosestOfSegments(a0, a1, b0, b1);
  return (closest.on_two - closest.on_one).norm();
}

double BallGap(const Shape& shape, const Isometry3d& X_WL, const Vector3d& p_WO, double radius) {
  if (shape.kind == Shape::Kind::kCapsule)
    return PointToSegment(p_WO, X_WL * shape.a_L, X_WL * shape.b_L) - shape.radius - radius;
  const Vector3d p = (X_WL * shape.X_LB).inverse() * p_WO;
  const Vector3d out = p.cwiseAbs() - shape.half_extents;
  const double inside = std::min(0.0, out.maxCoeff());
  return out.cwiseMax(0.0).norm() + inside - radius;
}

/// Finger that moves each link, -1 for the palm and what several move.
std::vector<int> FingerOfLink(const HandModel& hand) {
  std::vector<int> finger(hand.links.size(), -1);
  for (int f = 0; f < hand.num_fingers(); ++f)
    for (int l = hand.fingers[static_cast<std::size_t>(f)].tip_link; l > 0;
         l = hand.joints[static_cast<std::size_t>(
                             hand.links[static_cast<std::size_t>(l)].parent_joint)]
                 .parent_link) {
      int& of = finger[static_cast<std::size_t>(l)];
      of = of == -1 ? f : -2;
    }
  for (int& f : finger) f = std::max(f, -1);
  return finger;
}

/// Largest relative gain in manipulability within 5 mm along the surface: something to climb.
double RoomToClimb(const HandModel& hand, const BallGrasp& c, int f, double radius) {
  KinematicsData data;
  const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
  const auto Phi = [&](const JointVector& q) {
    ForwardKinematics(hand, q, &data);
    const Vector3d tip = FingertipCentre(hand, data, f);
    const Vector3d n = (c.p_WO - tip).normalized();
    return Manipulability(PointJacobian(hand, data, f, tip + n * finger.tip_radius));
  };
  const double here = Phi(c.q);
  const Vector3d direction = (FingertipCentre(hand, data, f) - c.p_WO).normalized();
  const Matrix3d R = RotationFromZ(direction);
  double best = 0;
  for (int k = 0; k < 6; ++k) {
    const double a = k * M_PI / 3;
    const Vector3d there =
        (direction + kClimbReach / radius * (std::cos(a) * R.col(0) + std::sin(a) * R.col(1)))
            .normalized();
    JointVector q = c.q;
    if (TouchAt(hand, radius, c.p_WO, f, there, &q)) best = std::max(best, Phi(q) / here - 1);
  }
  return best;
}

double RoomToLimits(const HandModel& hand, const JointVector& q) {
  double room = 1e9;
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
    const double half = 0.5 * (joint.upper - joint.lower);
    room = std::min(room, 1.0 - std::abs(q[j] - 0.5 * (joint.upper + joint.lower)) / half);
  }
  return room;
}

}  // namespace

Vector3d TipAxis(const HandModel& hand, const KinematicsData& data, int f) {
  const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
  const auto l = static_cast<std::size_t>(finger.tip_link);
  const Shape& tip = hand.links[l].shapes.front();
  Vector3d axis = tip.b_L - tip.a_L;
  if (axis.norm() < 1e-4) axis = finger.p_LF;  // a sphere: from the joint
  return (data.X_WL[l].linear() * axis).normalized();
}

bool TouchBall(const HandModel& hand, double radius, const Vector3d& p_WO, JointVector* q) {
  KinematicsData data;
  for (int pass = 0; pass < 6; ++pass) {  // fingers may share a drive
    bool all = true;
    for (int f = 0; f < hand.num_fingers(); ++f) {
      const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
      const double wanted = radius + finger.tip_radius;
      for (int k = 0;; ++k) {
        ForwardKinematics(hand, *q, &data);
        const Vector3d tip = FingertipCentre(hand, data, f);
        const Vector3d away = tip - p_WO;
        const double error = away.norm() - wanted;
        if (std::abs(error) < kTouched) break;
        all = false;
        if (k == 20) return false;
        const FingerVector g = PointJacobian(hand, data, f, tip).transpose() * away.normalized();
        const double step = std::clamp(error, -0.02, 0.02) / (g.squaredNorm() + 1e-6);
        for (std::size_t i = 0; i < finger.joints.size(); ++i) {
          (*q)[finger.joints[i]] -= step * g[static_cast<Eigen::Index>(i)];
          Clamp(hand, finger.joints[i], &(*q)[finger.joints[i]]);
        }
      }
    }
    if (all) return true;
  }
  return false;
}

bool TouchAt(const HandModel& hand, double radius, const Vector3d& p_WO, int f,
             const Vector3d& outward, JointVector* q) {
  KinematicsData data;
  const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
  const Vector3d target = p_WO + outward * (radius + finger.tip_radius);
  for (int k = 0; k < 40; ++k) {
    ForwardKinematics(hand, *q, &data);
    const Vector3d tip = FingertipCentre(hand, data, f);
    const Vector3d error = target - tip;
    if (error.norm() < kTouched) return true;
    const FingerJacobian J = PointJacobian(hand, data, f, tip);
    const FingerVector dq =
        J.transpose() * (J * J.transpose() + 1e-5 * Matrix3d::Identity()).inverse() * error;
    for (std::size_t i = 0; i < finger.joints.size(); ++i) {
      (*q)[finger.joints[i]] += dq[static_cast<Eigen::Index>(i)];
      Clamp(hand, finger.joints[i], &(*q)[finger.joints[i]]);
    }
  }
  return false;
}

double Clearance(const HandModel& hand, const KinematicsData& data, const Vector3d& p_WO,
                 double radius) {
  double gap = 1e9;
  const std::vector<int> finger_of = FingerOfLink(hand);
  for (std::size_t a = 0; a < hand.links.size(); ++a) {
    const int of_a = finger_of[a];
    const bool tip =
        of_a >= 0 && static_cast<int>(a) == hand.fingers[static_cast<std::size_t>(of_a)].tip_link;
    for (const Shape& shape : hand.links[a].shapes) {
      const bool touches = tip && &shape == &hand.links[a].shapes.front();
      if (!touches)
        gap = std::min(gap, BallGap(shape, data.X_WL[a], p_WO, radius) - (a == 0 ? kPalmGap : 0));
      if (of_a < 0) continue;
      const Shape sa = AsCapsule(shape);
      const Vector3d a0 = data.X_WL[a] * sa.a_L, a1 = data.X_WL[a] * sa.b_L;
      for (std::size_t b = a + 1; b < hand.links.size(); ++b) {
        if (finger_of[b] < 0 || of_a == finger_of[b]) continue;
        for (const Shape& other : hand.links[b].shapes) {
          const Shape sb = AsCapsule(other);
          const Vector3d b0 = data.X_WL[b] * sb.a_L, b1 = data.X_WL[b] * sb.b_L;
          const double reach = 0.5 * ((a1 - a0).norm() + (b1 - b0).norm()) + sa.radius + sb.radius;
          if (0.5 * (a0 + a1 - b0 - b1).norm() - reach > std::min(gap, 2 * kClear)) continue;
          gap = std::min(gap, SegmentDistance(a0, a1, b0, b1) - sa.radius - sb.radius);
        }
      }
    }
  }
  return gap;
}

void RateGrasp(const HandModel& hand, const BallTask& task, double enough, BallGrasp* c) {
  KinematicsData data;
  ForwardKinematics(hand, c->q, &data);
  const int n = hand.num_fingers();
  c->clearance = Clearance(hand, data, c->p_WO, task.radius);
  c->room = RoomToLimits(hand, c->q);
  c->sigma = c->facing = 1e9;
  c->push = 1;
  c->manipulability.clear();
  std::vector<GraspContact> contacts;
  bool dexterous = true;  // every finger has three joints
  for (int f = 0; f < n; ++f) {
    const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
    const Vector3d tip = FingertipCentre(hand, data, f);
    const Vector3d to = (c->p_WO - tip).normalized();
    contacts.push_back({-to * task.radius, to, task.friction});
    const FingerJacobian J = PointJacobian(hand, data, f, tip + to * finger.tip_radius);
    c->manipulability.push_back(J.cols() >= 3 ? Manipulability(J) : 0.0);
    c->facing = std::min(c->facing, TipAxis(hand, data, f).dot(to));
    dexterous = dexterous && J.cols() >= 3;
    const auto values = Eigen::JacobiSVD<Eigen::Matrix3Xd>(Eigen::Matrix3Xd(J)).singularValues();
    if (J.cols() >= 3)
      c->sigma = std::min(c->sigma, values[2]);
    else
      c->push = std::min(c->push, (J.transpose() * to).norm() / values[0]);
  }
  if (c->sigma == 1e9) c->sigma = 0;
  c->score = 1.5 * std::min(c->room, 0.5) / 0.5 + std::min(c->sigma, 0.03) / 0.03 +
             std::min(0.0, (c->clearance - kClear) / 0.001) +
             std::min(0.0, (c->facing - kFacing) / 0.05) + std::min(0.0, (c->push - kPush) / 0.05);
  if (c->score + kMostOfMargins + kMostOfClimb <= enough) return;

  const auto margin = [&](int without) {
    std::vector<GraspContact> rest;
    for (int f = 0; f < n; ++f)
      if (f != without) rest.push_back(contacts[static_cast<std::size_t>(f)]);
    return SignedLoadMargin(rest, task.weight, task.radius, task.max_force);
  };
  c->load_margin = margin(-1);
  c->margin_without.clear();
  for (int f = 0; f < n; ++f) c->margin_without.push_back(margin(f));
  const auto least = std::ranges::min_element(c->margin_without);
  c->opposing = static_cast<int>(least - c->margin_without.begin());
  double others = 1e9;
  for (int f = 0; f < n; ++f)
    if (f != c->opposing) others = std::min(others, c->margin_without[static_cast<std::size_t>(f)]);
  const bool none_leaves = n < kFewestToRegrasp;
  const double one_less = none_leaves ? c->load_margin : *least;
  if (none_leaves) others = c->load_margin;
  c->score += 2.0 * std::min(one_less, 0.3) / 0.3 + std::min(one_less, 1.5) +
              std::min(others, 1.0) + std::min(c->load_margin, 1.5);
  if (c->score + kMostOfClimb <= enough) return;
  c->climb = dexterous ? 1e9 : 0;
  if (dexterous)
    for (int f = 0; f < n; ++f)
      c->climb = std::min(c->climb, RoomToClimb(hand, *c, f, task.radius));
  c->score += kMostOfClimb * std::min(c->climb, 0.08) / 0.08;
}

}  // namespace regrasp
