#include "core/session/start.h"

#include <algorithm>
#include <initializer_list>

#include "core/common/random.h"
#include "core/hand/damped_inverse.h"
#include "core/hand/kinematics.h"
#include "core/session/session.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kStartStream = 1000;  // random stream of the start posture

/// Inverse kinematics of one fingertip by damped least squares; stops at joint limits.
void MoveTip(const HandModel& hand, int finger, const Vector3d& target, JointVector* q) {
  KinematicsData data;
  for (int k = 0; k < 20; ++k) {
    ForwardKinematics(hand, *q, &data);
    const Vector3d tip = FingertipCentre(hand, data, finger);
    const FingerJacobian J = PointJacobian(hand, data, finger, tip);
    const FingerVector dq = J.transpose() * (DampedInverse(J, 1e-5) * (target - tip));
    for (std::size_t n = 0; n < hand.fingers[finger].joints.size(); ++n) {
      const int j = hand.fingers[finger].joints[n];
      (*q)[j] = std::clamp((*q)[j] + dq[static_cast<Eigen::Index>(n)], hand.joints[j].lower,
                           hand.joints[j].upper);
    }
  }
}

/// Moves each fingertip's way in by `displacement` [m], along the surface in a random direction.
void Displace(const HandModel& hand, double displacement, const Vector3d& p_WO,
              RandomStream* random, std::initializer_list<JointVector*> postures) {
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const Vector3d direction = random->Normal3();
    if (displacement == 0) continue;
    for (JointVector* q : postures) {
      KinematicsData data;
      ForwardKinematics(hand, *q, &data);
      const Vector3d tip = FingertipCentre(hand, data, i);
      const Vector3d along = TangentPart(direction, (tip - p_WO).normalized()).normalized();
      MoveTip(hand, i, tip + displacement * along, q);
    }
  }
}

}  // namespace

StartPosture MakeStart(const HandModel& hand, const Scenario& scenario,
                       const StartParameters& spread, std::uint64_t seed) {
  RandomStream random(seed, kStartStream);
  StartPosture start{scenario.q_preshape, scenario.q_closed, scenario.X_WO,
                     scenario.X_WO.translation()};
  for (int j = 0; j < hand.num_joints(); ++j) {
    // The same offset for both, so that the fingers really touch elsewhere.
    const double offset = spread.joint_sigma_rad * random.Normal();
    for (JointVector* q : {&start.q_open, &start.q_closed})
      (*q)[j] = std::clamp((*q)[j] + offset, hand.joints[j].lower, hand.joints[j].upper);
  }
  Displace(hand, spread.displacement_m, scenario.X_WO.translation(), &random,
           {&start.q_open, &start.q_closed});
  start.X_WO.translation() += spread.object_sigma_m * random.Normal3();
  return start;
}

}  // namespace regrasp
