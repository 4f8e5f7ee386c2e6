// Searches the generic preshape and closed posture of a hand for its scenario file.
//   posture [--hand NAME] [--seed S] [--steps N] [--radius MM] [--tilt DEG] [--reach 0..1]
//           [--keep 1]   keeps the scenario's object, closed posture and touch; only the way in
// Random hill climbing, from the scenario as it is and within `reach` of it, over object position,
// contact directions and redundant joint angles. A posture is good when the grasp without each
// finger in turn (the thumb above all) keeps a load margin, joints are far from their limits, no
// finger is near singular and links keep clear of each other. Prints TOML.

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/common/random.h"
#include "core/hand/kinematics.h"
#include "core/hand/scenario.h"
#include "core/quality/load_margin.h"
#include "core/quality/manipulability.h"

using namespace regrasp;

namespace {

constexpr double kPi = 3.14159265358979323846;

struct Candidate {
  JointVector q;
  Vector3d p_WO;
  double score = -1e9;
  std::vector<double> rho;  // without each finger
  double clearance = 0, margin = 0, sigma = 0, room = 0;
};

/// Moves the tip of `finger` to `target` from `q`; false when it does not get there inside the
/// limits.
bool SolveTip(const HandModel& hand, int finger, const Vector3d& target, JointVector* q) {
  KinematicsData data;
  for (int k = 0; k < 60; ++k) {
    ForwardKinematics(hand, *q, &data);
    const Vector3d tip = FingertipCentre(hand, data, finger);
    const Vector3d error = target - tip;
    if (error.norm() < 1e-5) return true;
    const FingerJacobian J = PointJacobian(hand, data, finger, tip);
    const FingerVector dq =
        J.transpose() * (J * J.transpose() + 1e-5 * Matrix3d::Identity()).inverse() * error;
    const auto& joints = hand.fingers[finger].joints;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const Joint& joint = hand.joints[joints[i]];
      (*q)[joints[i]] =
          std::clamp((*q)[joints[i]] + dq[static_cast<Eigen::Index>(i)], joint.lower, joint.upper);
    }
  }
  return false;
}

double SegmentDistance(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                       const Vector3d& b1) {
  double best = 1e9;  // sampled: 0.3 mm is plenty here
  for (int i = 0; i <= 12; ++i) {
    const Vector3d p = a0 + (a1 - a0) * (i / 12.0);
    const Vector3d d = b1 - b0;
    const double len = d.squaredNorm();
    const double t = len > 0 ? std::clamp((p - b0).dot(d) / len, 0.0, 1.0) : 0.0;
    best = std::min(best, (p - b0 - t * d).norm());
  }
  return best;
}

/// Smallest gap between links of different fingers, and of links that are not tips to the object.
double Clearance(const HandModel& hand, const KinematicsData& data, const Vector3d& p_WO,
                 double radius) {
  double gap = 1e9;
  std::vector<int> finger_of(hand.links.size(), -1);
  for (int f = 0; f < hand.num_fingers(); ++f)
    for (int j : hand.fingers[f].joints) finger_of[hand.joints[j].child_link] = f;
  for (std::size_t a = 1; a < hand.links.size(); ++a) {
    for (const Shape& sa : hand.links[a].shapes) {
      if (sa.kind != Shape::Kind::kCapsule || finger_of[a] < 0) continue;
      const Vector3d a0 = data.X_WL[a] * sa.a_L, a1 = data.X_WL[a] * sa.b_L;
      if (static_cast<int>(a) != hand.fingers[finger_of[a]].tip_link)
        gap = std::min(gap, SegmentDistance(a0, a1, p_WO, p_WO) - sa.radius - radius);
      for (std::size_t b = a + 1; b < hand.links.size(); ++b) {
        if (finger_of[b] < 0 || finger_of[a] == finger_of[b]) continue;
        for (const Shape& sb : hand.links[b].shapes) {
          if (sb.kind != Shape::Kind::kCapsule) continue;
          gap =
              std::min(gap, SegmentDistance(a0, a1, data.X_WL[b] * sb.a_L, data.X_WL[b] * sb.b_L) -
                                sa.radius - sb.radius);
        }
      }
    }
  }
  for (const Shape& palm : hand.links[0].shapes) {  // the object keeps off the palm
    if (palm.kind != Shape::Kind::kBox) continue;
    const Vector3d p = palm.X_LB.inverse() * p_WO;
    const Vector3d outside = (p.cwiseAbs() - palm.half_extents).cwiseMax(0.0);
    gap = std::min(gap, outside.norm() - radius - 0.004);
  }
  return gap;
}

/// Largest relative gain in manipulability within 5 mm along the surface: something to climb.
double RoomToClimb(const HandModel& hand, const Candidate& c, int f, double radius) {
  KinematicsData data;
  const auto Phi = [&](const JointVector& q) {
    ForwardKinematics(hand, q, &data);
    const Vector3d tip = FingertipCentre(hand, data, f);
    const Vector3d n = (c.p_WO - tip).normalized();
    return Manipulability(PointJacobian(hand, data, f, tip + n * hand.fingers[f].tip_radius));
  };
  const double here = Phi(c.q);
  const Vector3d direction = (FingertipCentre(hand, data, f) - c.p_WO).normalized();
  const Matrix3d R = RotationFromZ(direction);
  double best = 0;
  for (int k = 0; k < 8; ++k) {
    const double a = k * kPi / 4;
    const Vector3d there =
        (direction + 0.005 / radius * (std::cos(a) * R.col(0) + std::sin(a) * R.col(1)))
            .normalized();
    JointVector q = c.q;
    if (!SolveTip(hand, f, c.p_WO + there * (radius + hand.fingers[f].tip_radius), &q)) continue;
    best = std::max(best, Phi(q) / here - 1);
  }
  return best;
}

void Evaluate(const HandModel& hand, double radius, const Vector3d& gravity, Candidate* c) {
  KinematicsData data;
  ForwardKinematics(hand, c->q, &data);
  c->clearance = Clearance(hand, data, c->p_WO, radius);
  c->margin = 1e9;
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[j];
    const double half = 0.5 * (joint.upper - joint.lower);
    c->margin =
        std::min(c->margin, 1.0 - std::abs(c->q[j] - 0.5 * (joint.upper + joint.lower)) / half);
  }
  std::vector<GraspContact> contacts;
  c->sigma = 1e9;
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const Vector3d tip = FingertipCentre(hand, data, f);
    const Vector3d n = (c->p_WO - tip).normalized();
    contacts.push_back({-n * radius, n, 0.5});
    const Eigen::Matrix3Xd J = PointJacobian(hand, data, f, tip + n * hand.fingers[f].tip_radius);
    c->sigma = std::min(c->sigma, Eigen::JacobiSVD<Eigen::Matrix3Xd>(J).singularValues()[2]);
  }
  c->rho.clear();
  double worst_other = 1e9;
  const int last = hand.num_fingers() - 1;
  for (int without = 0; without <= last; ++without) {
    std::vector<GraspContact> rest;
    for (int f = 0; f <= last; ++f)
      if (f != without) rest.push_back(contacts[f]);
    c->rho.push_back(LoadMargin(rest, 0.08 * gravity, radius, 4.0));
    if (without < last) worst_other = std::min(worst_other, c->rho.back());
  }
  c->room = 1e9;
  for (int f = 0; f <= last; ++f) c->room = std::min(c->room, RoomToClimb(hand, *c, f, radius));
  c->score = 1.5 * std::min(c->room, 0.08) / 0.08 + 2.0 * std::min(c->rho[last], 0.3) / 0.3 +
             1.0 * std::min(c->rho[last], 1.5) + 1.0 * std::min(worst_other, 1.0) +
             1.5 * std::min(c->margin, 0.5) / 0.5 + 1.0 * std::min(c->sigma, 0.03) / 0.03 +
             std::min(0.0, (c->clearance - 0.005) / 0.001);
}

/// Where finger `f` first touches on its straight way from `open` to `closed`: its joints there.
/// False when it never does.
bool Touch(const HandModel& hand, const JointVector& open, const JointVector& closed,
           const Vector3d& p_WO, double radius, int f, JointVector* q) {
  KinematicsData data;
  JointVector way = *q;
  for (int k = 0; k <= 200; ++k) {
    for (int j : hand.fingers[f].joints) way[j] = open[j] + k / 200.0 * (closed[j] - open[j]);
    ForwardKinematics(hand, way, &data);
    const double distance = (FingertipCentre(hand, data, f) - p_WO).norm();
    if (distance > radius + hand.fingers[f].tip_radius) continue;
    *q = way;
    return true;
  }
  return false;
}

/// The way in of finger `f`: a straight line in joint space through its joints in `grip`, from
/// `gap` off the object to `depth` inside it, so that it touches where `grip` does. Random search
/// over directions for joints off their limits, links clear of each other and a short, straight
/// way; the best goes into `open` and `closed`.
void FindWayIn(const HandModel& hand, const Candidate& grip, double radius, double gap,
               double depth, int f, RandomStream* random, JointVector* open, JointVector* closed) {
  constexpr int kTrials = 1500;
  constexpr double kStep = 0.02;  // rad
  const auto& joints = hand.fingers[f].joints;
  KinematicsData data;
  ForwardKinematics(hand, grip.q, &data);
  const Vector3d tip = FingertipCentre(hand, data, f);
  const Vector3d touch = (tip - grip.p_WO).normalized();
  const FingerJacobian J = PointJacobian(hand, data, f, tip);
  const FingerVector radial =
      J.transpose() * (J * J.transpose() + 1e-5 * Matrix3d::Identity()).inverse() * touch;
  double best = -1e9;
  for (int trial = 0; trial < kTrials; ++trial) {
    FingerVector direction = radial.normalized();
    for (Eigen::Index k = 0; k < direction.size(); ++k) direction[k] += 0.4 * random->Normal();
    direction.normalize();
    // Along the line from the grip until the tip is `until` from the surface; false at a limit.
    const auto Go = [&](double sign, double until, JointVector* q) {
      for (int k = 0; k < 80; ++k) {
        ForwardKinematics(hand, *q, &data);
        const double off = (FingertipCentre(hand, data, f) - grip.p_WO).norm() - radius -
                           hand.fingers[f].tip_radius;
        if (sign * off >= sign * until) return true;
        for (std::size_t n = 0; n < joints.size(); ++n) {
          const Joint& joint = hand.joints[joints[n]];
          double& angle = (*q)[joints[n]];
          angle += sign * kStep * direction[static_cast<Eigen::Index>(n)];
          if (angle < joint.lower || angle > joint.upper) return false;
        }
      }
      return false;
    };
    JointVector out = *open, in = *closed;
    for (int j : joints) out[j] = in[j] = grip.q[j];
    if (!Go(-1, -depth, &in) || !Go(1, gap, &out)) continue;
    double margin = 1, length = 0;
    for (int j : joints) {
      for (double q : {out[j], in[j]})
        margin = std::min({margin, q - hand.joints[j].lower, hand.joints[j].upper - q});
      length = std::hypot(length, out[j] - in[j]);
    }
    ForwardKinematics(hand, out, &data);
    const double clearance = Clearance(hand, data, grip.p_WO, radius);
    const double drift = ((FingertipCentre(hand, data, f) - grip.p_WO).normalized() - touch).norm();
    const double score = 2 * std::min(margin, 0.1) / 0.1 - drift / 0.3 - 0.3 * length +
                         std::min(0.0, (clearance - 0.005) / 0.001);
    if (score <= best) continue;
    best = score;
    *open = out;
    *closed = in;
  }
  if (best == -1e9) std::fprintf(stderr, "%s finds no way in\n", hand.fingers[f].name.c_str());
}

/// Smallest gap between links while all fingers close from `open` to `closed`, each until it
/// touches a ball of `radius`; `landed` gets the posture in which all touch.
double GapOnTheWay(const HandModel& hand, const JointVector& open, const JointVector& closed,
                   const Vector3d& p_WO, double radius, JointVector* landed) {
  constexpr int kSteps = 40;
  KinematicsData data;
  double gap = 1e9;
  *landed = open;
  for (int k = 0; k <= kSteps; ++k) {
    ForwardKinematics(hand, *landed, &data);
    gap = std::min(gap, Clearance(hand, data, p_WO, 0.5 * radius));
    for (int f = 0; f < hand.num_fingers(); ++f) {
      if ((FingertipCentre(hand, data, f) - p_WO).norm() < radius + hand.fingers[f].tip_radius)
        continue;
      for (int j : hand.fingers[f].joints)
        (*landed)[j] = open[j] + (closed[j] - open[j]) * k / kSteps;
    }
  }
  return gap;
}

}  // namespace

int main(int argc, char** argv) {
  std::string name = "shadow";
  std::uint64_t seed = 1;
  int steps = 20000;
  double radius = 0.025, tilt = 65, reach = 1;
  bool keep = false;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string a = argv[i];
    if (a == "--hand") name = argv[i + 1];
    if (a == "--seed") seed = std::stoull(argv[i + 1]);
    if (a == "--steps") steps = std::stoi(argv[i + 1]);
    if (a == "--radius") radius = std::stod(argv[i + 1]) * 1e-3;
    if (a == "--reach") reach = std::stod(argv[i + 1]);
    if (a == "--keep") keep = std::stoi(argv[i + 1]) != 0;
    if (a == "--tilt") tilt = std::stod(argv[i + 1]);
  }
  const LoadedScenario model = LoadScenario(name, "", ModelSearchPath());
  const HandModel& hand = model.hand;
  const Vector3d gravity =
      9.81 * Vector3d(0, std::cos(tilt * kPi / 180), std::sin(tilt * kPi / 180));
  RandomStream random(seed, 0);

  const auto TipTarget = [&](const Candidate& c, int f, const Vector3d& direction,
                             double distance) {
    return Vector3d(c.p_WO + direction * (distance + hand.fingers[f].tip_radius));
  };
  const auto Direction = [&](const Candidate& c, int f) {
    KinematicsData data;
    ForwardKinematics(hand, c.q, &data);
    return Vector3d((FingertipCentre(hand, data, f) - c.p_WO).normalized());
  };

  Candidate best;
  best.q = 0.5 * (model.scenario.q_preshape + model.scenario.q_closed);
  best.p_WO = model.scenario.X_WO.translation();
  for (int f = 0; f < hand.num_fingers(); ++f)
    SolveTip(hand, f, TipTarget(best, f, Direction(best, f), radius), &best.q);
  if (keep) {
    steps = 0;
    for (int f = 0; f < hand.num_fingers(); ++f)
      Touch(hand, model.scenario.q_preshape, model.scenario.q_closed, best.p_WO, radius, f,
            &best.q);
  }
  Evaluate(hand, radius, gravity, &best);
  std::fprintf(stderr, "start: score %.3f\n", best.score);

  for (int step = 0; step < steps; ++step) {
    const double scale = reach * std::pow(0.1, 1.5 * step / steps);
    Candidate c = best;
    std::vector<Vector3d> directions;
    for (int f = 0; f < hand.num_fingers(); ++f) directions.push_back(Direction(c, f));
    if (random.Uniform() < 0.3) c.p_WO += 0.004 * scale * random.Normal3();
    for (int f = 0; f < hand.num_fingers(); ++f) {
      if (random.Uniform() < 0.4)
        directions[f] = (directions[f] + 0.25 * scale * random.Normal3()).normalized();
      if (random.Uniform() < 0.3)
        for (int j : hand.fingers[f].joints) {
          c.q[j] += 0.2 * scale * random.Normal();
          c.q[j] = std::clamp(c.q[j], hand.joints[j].lower, hand.joints[j].upper);
        }
    }
    bool reached = true;
    for (int f = 0; f < hand.num_fingers() && reached; ++f)
      reached = SolveTip(hand, f, TipTarget(c, f, directions[f], radius), &c.q);
    if (!reached) continue;
    Evaluate(hand, radius, gravity, &c);
    if (c.score > best.score) best = c;
  }

  constexpr double kGap = 0.018;     // leaves 9 mm to a sphere of 68 mm diameter
  constexpr double kDepth = 0.0075;  // reaches into a sphere of 35 mm diameter
  constexpr double kClear = 0.005;
  constexpr int kWays = 20;
  Candidate open = best, closed = best;
  double way_score = -1e9;
  for (int attempt = 0; attempt < kWays; ++attempt) {
    JointVector out = best.q, in = best.q, landed;
    for (int f = 0; f < hand.num_fingers(); ++f)
      FindWayIn(hand, best, radius, kGap, kDepth, f, &random, &out, &in);
    double gap = 1e9;
    Candidate other = best;
    double score = 0;
    for (double r : {radius + 0.005, radius - 0.0025}) {  // the claimed sizes
      gap = std::min(gap, GapOnTheWay(hand, out, in, best.p_WO, r, &landed));
      other.q = landed;
      Evaluate(hand, r, gravity, &other);
      score += other.score;
    }
    score += std::min(0.0, (gap - kClear) / 0.001);
    if (score <= way_score) continue;
    way_score = score;
    open.q = out;
    closed.q = in;
    std::fprintf(stderr, "way in %d: score %.3f, gap %.1f mm\n", attempt, score, 1e3 * gap);
  }
  Evaluate(hand, radius, gravity, &open);
  Evaluate(hand, radius, gravity, &closed);
  std::printf(
      "# posture --hand %s --seed %llu --steps %d --radius %g --tilt %g\n# score %.3f, clearance "
      "%.1f mm (open %.1f, closed %.1f), joint margin %.2f, sigma_min %.4f m, room to climb %.1f "
      "%%, load margin without",
      name.c_str(), static_cast<unsigned long long>(seed), steps, radius * 1e3, tilt, best.score,
      best.clearance * 1e3, open.clearance * 1e3, closed.clearance * 1e3, best.margin, best.sigma,
      100 * best.room);
  for (int f = 0; f < hand.num_fingers(); ++f)
    std::printf(" %s %.2f N", hand.fingers[f].name.c_str(), best.rho[f]);
  std::printf("\n#");
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const Vector3d d = Direction(best, f);
    std::printf(" %s (%.2f %.2f %.2f)", hand.fingers[f].name.c_str(), d.x(), d.y(), d.z());
  }
  std::printf("\n[object_pose]\nposition_m = [%.5f, %.5f, %.5f]\n", best.p_WO.x(), best.p_WO.y(),
              best.p_WO.z());
  for (const auto& [table, c] :
       {std::pair{"q_preshape_deg", &open}, std::pair{"q_closed_deg", &closed}}) {
    std::printf("\n[%s]\n", table);
    for (int j = 0; j < hand.num_joints(); ++j)
      std::printf("%s = %.2f\n", hand.joints[j].name.c_str(), c->q[j] * 180 / kPi);
  }
}
