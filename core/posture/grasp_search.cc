#include "core/posture/grasp_search.h"

#include <algorithm>
#include <cmath>

#include "core/common/random.h"

namespace regrasp {
namespace {

constexpr int kSamples = 300;    // postures per finger
constexpr int kPlaces = 3000;    // of the ball
constexpr double kNear = 0.02;   // a tip so near to the surface is pulled onto it [m]
constexpr double kMiddle = 0.8;  // of each joint's range: starts lie within it

struct TipSample {
  JointVector q;  // of the whole hand
  Vector3d p_W, axis_W;
};

double Uniform(RandomStream* random, double a, double b) { return a + (b - a) * random->Uniform(); }

JointVector RandomPosture(const HandModel& hand, RandomStream* random) {
  JointVector q(hand.num_joints());
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
    const double middle = 0.5 * (joint.lower + joint.upper), half = middle - joint.lower;
    q[j] = Uniform(random, middle - kMiddle * half, middle + kMiddle * half);
  }
  return q;
}

/// A ball between the tips of a random posture, each finger then in that of its sampled postures
/// which suits it best.
bool RandomStart(const HandModel& hand, double radius,
                 const std::vector<std::vector<TipSample>>& samples, RandomStream* random,
                 BallGrasp* start) {
  const int n = hand.num_fingers();
  start->p_WO.setZero();
  for (int f = 0; f < n; ++f)
    start->p_WO += samples[static_cast<std::size_t>(f)][random->NextBits() % kSamples].p_W / n;
  start->q.resize(hand.num_joints());
  for (int j = 0; j < hand.num_joints(); ++j) {
    const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
    start->q[j] = std::clamp(0.0, joint.lower, joint.upper);
  }
  for (int f = 0; f < n; ++f) {
    const Finger& finger = hand.fingers[static_cast<std::size_t>(f)];
    const TipSample* best = nullptr;
    double least = kNear;
    for (const TipSample& s : samples[static_cast<std::size_t>(f)]) {
      const Vector3d to = start->p_WO - s.p_W;
      const double off = std::abs(to.norm() - radius - finger.tip_radius);
      const double facing = s.axis_W.dot(to.normalized());
      const double cost = off + 0.02 * std::max(0.0, 0.3 - facing) + 0.01 * random->Uniform();
      if (cost >= least) continue;
      least = cost;
      best = &s;
    }
    if (best == nullptr) return false;
    for (const int j : finger.joints) start->q[j] = best->q[j];
  }
  return TouchBall(hand, radius, start->p_WO, &start->q);
}

}  // namespace

BallGrasp ClimbGrasp(const HandModel& hand, const GraspSearch& search, const BallGrasp& start) {
  RandomStream random(search.seed, 1);
  BallGrasp best = start;
  if (TouchBall(hand, search.task.radius, best.p_WO, &best.q))
    RateGrasp(hand, search.task, -1e9, &best);
  else
    best.score = -1e9;
  for (int step = 0; step < search.steps; ++step) {
    const double scale = search.reach * std::pow(0.1, 1.5 * step / search.steps);
    BallGrasp c = best;
    if (random.Uniform() < 0.4) c.p_WO += 0.004 * scale * random.Normal3();
    for (const Finger& finger : hand.fingers)
      if (random.Uniform() < 0.5)
        for (const int j : finger.joints) {
          const Joint& joint = hand.joints[static_cast<std::size_t>(j)];
          c.q[j] = std::clamp(c.q[j] + 0.2 * scale * random.Normal(), joint.lower, joint.upper);
        }
    if (!TouchBall(hand, search.task.radius, c.p_WO, &c.q)) continue;
    RateGrasp(hand, search.task, best.score, &c);
    if (c.score > best.score) best = c;
    if (step % 200 == 0) search.progress(static_cast<double>(step) / search.steps, best.score);
  }
  return best;
}

std::vector<BallGrasp> FindGrasps(const HandModel& hand, const GraspSearch& search) {
  RandomStream random(search.seed, 0);
  KinematicsData data;
  std::vector<std::vector<TipSample>> samples(static_cast<std::size_t>(hand.num_fingers()));
  for (int k = 0; k < kSamples; ++k) {
    const JointVector q = RandomPosture(hand, &random);
    ForwardKinematics(hand, q, &data);
    for (int f = 0; f < hand.num_fingers(); ++f)
      samples[static_cast<std::size_t>(f)].push_back(
          {q, FingertipCentre(hand, data, f), TipAxis(hand, data, f)});
  }
  std::vector<BallGrasp> found;
  const auto better = [](const BallGrasp& a, const BallGrasp& b) { return a.score > b.score; };
  for (int place = 0; place < kPlaces; ++place) {
    BallGrasp start;
    if (!RandomStart(hand, search.task.radius, samples, &random, &start)) continue;
    const bool full = static_cast<int>(found.size()) == search.starts;
    RateGrasp(hand, search.task, full ? found.back().score : -1e9, &start);
    if (full && start.score <= found.back().score) continue;
    if (full) found.pop_back();
    found.push_back(start);
    std::ranges::sort(found, better);
  }
  for (std::size_t k = 0; k < found.size(); ++k) {
    GraspSearch climb = search;
    climb.progress = [&](double done, double score) {
      search.progress((static_cast<double>(k) + done) / static_cast<double>(found.size()),
                      std::max(score, found.front().score));
    };
    found[k] = ClimbGrasp(hand, climb, found[k]);
  }
  std::ranges::sort(found, better);
  return found;
}

}  // namespace regrasp
