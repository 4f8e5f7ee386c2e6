// Two routes to the ground truth of an exploration: the map of phi about a contact.
//   phi_map [--seeds N] [--first S] [--rays N]
//
// Sliding: the finger slides along rays in the simulator, sensor noise off; what
// `regrasp experiment` judges explorations by (cli/experiment/phi_map.h).
//
// Geometry: inverse kinematics alone. The fingertip's centre stays at its distance from the centre
// of the sphere, the joints that this leaves free rest where the posture springs of the hybrid
// controller balance; reach is limited by the same disc and by FindWalls().
//
// Prints per finger phi at the start, the best by either route, and how far the two are apart (root
// mean square) on those points slid over that the round tip touched. A finger that starts at the
// side of its last link, or in a wall, has no best by geometry. Spheres only.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <vector>

#include "cli/experiment/straight_slide.h"
#include "core/control/estimate.h"
#include "core/exploration/walls.h"
#include "core/hand/scenario.h"
#include "core/quality/manipulability.h"
#include "core/session/session.h"

using namespace regrasp;

namespace {

constexpr int kSampleTicks = 50;
constexpr double kOnTip_m = 2e-4;          // contacts lie about 0.1 mm deep
constexpr double kWallTolerance_m = 3e-4;  // a finger slides along a wall that deep in it

struct Sample {
  Vector3d p_WC, p_WO;
  JointVector q;
  double phi;
  bool on_tip;  ///< the contact is on the fingertip's rounding sphere, not on the side of the link
};

double Phi(const HandModel& hand, const JointVector& q, int finger, const Vector3d& p_WC) {
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  return Manipulability(PointJacobian(hand, data, finger, p_WC)) / kManipulabilityUnit;
}

Vector3d Tip(const HandModel& hand, const JointVector& q, int finger) {
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  return FingertipCentre(hand, data, finger);
}

/// The finger's joints where its tip's centre is at `tip` and the posture and limit springs balance
/// in the null space, from `q` on.
JointVector Settle(const HandModel& hand, const ControlParameters& control, int finger,
                   const Vector3d& tip, const JointVector& q_rest, JointVector q) {
  const auto& joints = hand.fingers[finger].joints;
  const auto n = static_cast<Eigen::Index>(joints.size());
  double stiffest = control.posture_stiffness;  // a step of 1 / stiffness would just not overshoot
  for (int iteration = 0; iteration < 5000; ++iteration) {
    KinematicsData data;
    ForwardKinematics(hand, q, &data);
    const Vector3d at = FingertipCentre(hand, data, finger);
    const FingerJacobian J = PointJacobian(hand, data, finger, at);
    const Matrix3d inverse = (J * J.transpose() + 1e-9 * Matrix3d::Identity()).inverse();
    FingerVector spring(n);
    const double step = 0.2 / stiffest;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Joint& joint = hand.joints[joints[static_cast<std::size_t>(k)]];
      const double angle = q[joints[static_cast<std::size_t>(k)]];
      const double below = joint.lower + control.limit_margin - angle;
      const double above = angle - (joint.upper - control.limit_margin);
      spring[k] =
          control.posture_stiffness * (q_rest[joints[static_cast<std::size_t>(k)]] - angle) +
          control.limit_stiffness * (std::max(0.0, below) - std::max(0.0, above));
    }
    const FingerVector null = spring - J.transpose() * (inverse * (J * spring));
    Vector3d error = tip - at;
    if (error.norm() > 1e-3) error *= 1e-3 / error.norm();
    const FingerVector dq = J.transpose() * (inverse * error) + step * null;
    for (Eigen::Index k = 0; k < n; ++k) {
      const int j = joints[static_cast<std::size_t>(k)];
      q[j] = std::clamp(q[j] + dq[k], hand.joints[j].lower, hand.joints[j].upper);
    }
    if (dq.norm() < 1e-8) break;
  }
  return q;
}

double WallDepth(const HandModel& hand, const ExplorationParameters& parameters, int finger,
                 const JointVector& q, const Vector3d& p_WC, const Vector3d& normal_W,
                 double object_scale) {
  Estimate estimate;
  estimate.fingers.resize(hand.fingers.size());
  estimate.q = q;
  ForwardKinematics(hand, q, &estimate.kinematics);
  estimate.object_scale = object_scale;
  FingerEstimate& f = estimate.fingers[finger];
  f.p_WC = p_WC;
  f.normal_W = normal_W;
  f.J = PointJacobian(hand, estimate.kinematics, finger, p_WC);
  Walls walls;
  FindWalls(hand, estimate, finger, parameters, OnSide::kStay, &walls);
  double depth = 0;
  for (const Wall& wall : walls) depth = std::max(depth, wall.depth);
  return depth;
}

bool Grasped(Session* session) {
  Command grasp;
  grasp.type = CommandType::kGrasp;
  grasp.job = 1;
  session->Apply(grasp);
  while (session->tick() < 30000 && session->state() != SessionState::kHolding) session->Tick();
  return session->state() == SessionState::kHolding;
}

/// Slides along one ray from the grasp of this configuration.
std::vector<Sample> Slide(SessionConfig config, int finger, double angle) {
  for (const auto& [name, value] : cli::kStraightSlide)
    SetByUser(ParameterTable()[static_cast<std::size_t>(FindParameter(name))],
              Vector3d(value, 0, 0), &config.parameters);
  const double tip_radius = config.model.hand.fingers[static_cast<std::size_t>(finger)].tip_radius;
  Session session(std::move(config));
  std::vector<Sample> samples;
  if (!Grasped(&session)) return samples;
  Command explore;
  explore.type = CommandType::kExplore;
  explore.job = 2;
  explore.finger = finger;
  explore.estimator = Estimator::kSecant;
  explore.seed = static_cast<std::uint64_t>(cli::SeedOfDirection(angle));
  explore.max_cycles = 1000;
  session.Apply(explore);
  Frame frame;
  for (int tick = 0; tick < 4000 && session.job_running(); ++tick) {
    session.Tick();
    if (tick % kSampleTicks != 0) continue;
    session.Snapshot(&frame, false);
    const FingerFrame& f = frame.fingers[static_cast<std::size_t>(finger)];
    if (frame.exploration.cycle > 0 && f.true_contact)
      samples.push_back({f.true_p_WC, frame.p_WO, frame.q, f.true_manipulability,
                         std::abs((f.true_tip_W - f.true_p_WC).norm() - tip_radius) < kOnTip_m});
  }
  return samples;
}

}  // namespace

int main(int argc, char** argv) {
  int seeds = 2, rays = 12;
  std::uint64_t first = 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--seeds") == 0) seeds = std::atoi(argv[i + 1]);
    if (std::strcmp(argv[i], "--first") == 0) first = std::strtoull(argv[i + 1], nullptr, 10);
    if (std::strcmp(argv[i], "--rays") == 0) rays = std::atoi(argv[i + 1]);
  }
  std::printf("%-8s %4s %8s %8s %8s %10s %14s %14s\n", "finger", "seed", "start", "slid",
              "geometry", "geom/slid", "apart, % rms", "on the tip, %");
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(seeds); ++seed) {
    SessionConfig config;
    config.model = LoadScenario("shadow", "", ModelSearchPath());
    config.parameters = DefaultParameters(config.model);
    config.seed = seed;
    const HandModel hand = config.model.hand;
    const Parameters parameters = config.parameters;
    for (int finger = 0; finger < hand.num_fingers(); ++finger) {
      Session held(config);
      if (!Grasped(&held)) continue;
      const JointVector q_rest = held.truth().q;
      double start = 0, slid = 0, geometry = 0, square = 0;
      int count = 0, on_tip = 0;
      Sample begin{};
      double radius = 0, tip_distance = 0;
      for (int ray = 0; ray < rays; ++ray) {
        const auto samples = Slide(config, finger, 2 * std::numbers::pi * ray / rays);
        if (samples.empty()) continue;
        if (count == 0) {
          begin = samples.front();
          start = begin.phi;
          radius = (begin.p_WC - begin.p_WO).norm();
          tip_distance = (Tip(hand, begin.q, finger) - begin.p_WO).norm();
        }
        JointVector q = begin.q;
        for (const Sample& s : samples) {
          slid = std::max(slid, s.phi);
          ++count;
          if (!s.on_tip) continue;
          const Vector3d u = (s.p_WC - s.p_WO).normalized();
          q = Settle(hand, parameters.control, finger, s.p_WO + tip_distance * u, q_rest, q);
          const double phi = Phi(hand, q, finger, s.p_WC);
          square += (phi / s.phi - 1) * (phi / s.phi - 1);
          ++on_tip;
        }
      }
      if (count == 0) continue;
      const Vector3d n0 = (begin.p_WC - begin.p_WO).normalized();
      const Matrix3d R_WC = RotationFromZ(n0);
      const double deepest = std::max(
          kWallTolerance_m,
          WallDepth(hand, parameters.exploration, finger, begin.q, begin.p_WC, n0, radius));
      for (int direction = 0; begin.on_tip && direction < 36; ++direction) {
        JointVector q = begin.q;
        for (double distance = 0; distance <= parameters.exploration.max_excursion;
             distance += 5e-4) {
          const double a = 2 * std::numbers::pi * direction / 36;
          // The excursion is a chord's part in the tangent plane at the present contact.
          const double turn = std::asin(std::min(1.0, distance / radius));
          const Vector3d t = R_WC * Vector3d(std::cos(a), std::sin(a), 0);
          const Vector3d u = std::cos(turn) * n0 + std::sin(turn) * t;
          q = Settle(hand, parameters.control, finger, begin.p_WO + tip_distance * u, q_rest, q);
          const Vector3d p_WC = begin.p_WO + radius * u;
          if (WallDepth(hand, parameters.exploration, finger, q, p_WC, u, radius) > deepest) break;
          geometry = std::max(geometry, Phi(hand, q, finger, p_WC));
        }
      }
      char by_geometry[32] = "       -          -";
      if (geometry > 0)
        std::snprintf(by_geometry, sizeof(by_geometry), "%8.4f %10.3f", geometry, geometry / slid);
      std::printf("%-8s %4llu %8.4f %8.4f %s %14.2f %14.0f\n", hand.fingers[finger].name.c_str(),
                  static_cast<unsigned long long>(seed), start, slid, by_geometry,
                  on_tip > 0 ? 100 * std::sqrt(square / on_tip) : 0.0, 100.0 * on_tip / count);
      std::fflush(stdout);
    }
  }
  return 0;
}
