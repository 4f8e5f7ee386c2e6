#include "core/hand/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/common/random.h"
#include "core/hand/scenario.h"

namespace regrasp {
namespace {

HandModel Hand() { return LoadScenario("shadow", "sphere", ModelSearchPath()).hand; }

JointVector RandomPosture(const HandModel& hand, RandomStream* random) {
  JointVector q(hand.num_joints());
  for (int j = 0; j < q.size(); ++j)
    q[j] = hand.joints[j].lower + random->Uniform() * (hand.joints[j].upper - hand.joints[j].lower);
  return q;
}

double PotentialEnergy(const HandModel& hand, const JointVector& q, const Vector3d& gravity_W) {
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  double energy = 0;
  for (std::size_t l = 0; l < hand.links.size(); ++l)
    energy -= hand.links[l].mass * gravity_W.dot(data.X_WL[l] * hand.links[l].p_LCom);
  return energy;
}

TEST(Kinematics, StraightFingersStandWhereTheLinkLengthsPutThem) {
  const HandModel hand = Hand();
  KinematicsData data;
  ForwardKinematics(hand, JointVector::Zero(hand.num_joints()), &data);
  // Knuckle + .045 + .025 + .019 along z; decimal inputs, so only rounding.
  EXPECT_LT(
      (FingertipCentre(hand, data, hand.FindFinger("first")) - Vector3d(.033, 0, .184)).norm(),
      1e-12);
  EXPECT_LT(
      (FingertipCentre(hand, data, hand.FindFinger("middle")) - Vector3d(.011, 0, .188)).norm(),
      1e-12);
  EXPECT_LT(
      (FingertipCentre(hand, data, hand.FindFinger("ring")) - Vector3d(-.011, 0, .184)).norm(),
      1e-12);
  // The metacarpal's .06579 from .02071 leads straight up: the published numbers are rounded to .1
  // mm.
  EXPECT_LT(
      (FingertipCentre(hand, data, hand.FindFinger("little")) - Vector3d(-.033, 0, .17550)).norm(),
      1.5e-4);
  // At zero the thumb points along (1, 0, 1)/sqrt(2) from its root.
  const Vector3d thumb =
      Vector3d(.034, -.00858, .029) + (.038 + .032 + .0185) * Vector3d(1, 0, 1).normalized();
  EXPECT_LT((FingertipCentre(hand, data, hand.FindFinger("thumb")) - thumb).norm(), 1e-9);
}

TEST(Kinematics, FingersFlexTowardsThePalmsNormal) {
  const HandModel hand = Hand();
  for (const char* finger : {"first", "middle", "ring", "little"}) {
    const int f = hand.FindFinger(finger);
    JointVector q = JointVector::Zero(hand.num_joints());
    const auto& joints = hand.fingers[f].joints;
    for (std::size_t k = joints.size() - 3; k < joints.size(); ++k) q[joints[k]] = 0.5;
    KinematicsData data;
    ForwardKinematics(hand, q, &data);
    EXPECT_LT(FingertipCentre(hand, data, f).y(), -0.03) << finger;
  }
}

TEST(Kinematics, JacobianAgreesWithCentralDifferences) {
  const HandModel hand = Hand();
  RandomStream random(1, 0);
  KinematicsData data, plus, minus;
  const double h = 1e-6;
  for (int trial = 0; trial < 20; ++trial) {
    const JointVector q = RandomPosture(hand, &random);
    ForwardKinematics(hand, q, &data);
    for (int f = 0; f < hand.num_fingers(); ++f) {
      const Finger& finger = hand.fingers[f];
      const Vector3d p_LQ = finger.p_LF + 0.007 * random.Normal3();
      const FingerJacobian J = PointJacobian(hand, data, f, data.X_WL[finger.tip_link] * p_LQ);
      ASSERT_EQ(J.cols(), static_cast<int>(finger.joints.size()));
      for (int k = 0; k < J.cols(); ++k) {
        JointVector dq = JointVector::Zero(q.size());
        dq[finger.joints[k]] = h;
        ForwardKinematics(hand, q + dq, &plus);
        ForwardKinematics(hand, q - dq, &minus);
        const Vector3d difference =
            (plus.X_WL[finger.tip_link] * p_LQ - minus.X_WL[finger.tip_link] * p_LQ) / (2 * h);
        // Lever arms are below .2 m: truncation h²/6 * .2 = 3e-14, rounding 1e-17/h = 1e-11 or so.
        EXPECT_LT((difference - J.col(k)).norm(), 1e-9) << hand.joints[finger.joints[k]].name;
      }
    }
  }
}

TEST(Kinematics, OnlyTheJointsOfAFingerMoveItsTip) {
  const HandModel hand = Hand();
  RandomStream random(2, 0);
  const JointVector q = RandomPosture(hand, &random);
  KinematicsData data, moved;
  ForwardKinematics(hand, q, &data);
  for (int f = 0; f < hand.num_fingers(); ++f) {
    JointVector q2 = RandomPosture(hand, &random);
    for (const int j : hand.fingers[f].joints) q2[j] = q[j];
    ForwardKinematics(hand, q2, &moved);
    EXPECT_EQ(FingertipCentre(hand, data, f), FingertipCentre(hand, moved, f));
  }
}

TEST(Kinematics, GravityTorqueIsTheSlopeOfThePotentialEnergy) {
  const HandModel hand = Hand();
  RandomStream random(3, 0);
  KinematicsData data;
  const double h = 1e-5;
  for (int trial = 0; trial < 10; ++trial) {
    const JointVector q = RandomPosture(hand, &random);
    const Vector3d gravity_W = 9.81 * random.Normal3().normalized();
    ForwardKinematics(hand, q, &data);
    const JointVector torque = GravityTorque(hand, data, gravity_W);
    for (int j = 0; j < q.size(); ++j) {
      JointVector dq = JointVector::Zero(q.size());
      dq[j] = h;
      const double slope =
          (PotentialEnergy(hand, q + dq, gravity_W) - PotentialEnergy(hand, q - dq, gravity_W)) /
          (2 * h);
      // Energies are about 1 J: rounding 1e-16 / h = 1e-11 times some; torques are about .01 N m.
      EXPECT_NEAR(torque[j], slope, 1e-9) << hand.joints[j].name;
    }
  }
}

struct PublishedGrasp {
  const char* name;
  double degrees[22];  ///< FF, MF, RF as J4..J1; LF, TH as J5..J1
  Vector3d p_WO;
};

class PublishedPosture : public testing::TestWithParam<PublishedGrasp> {};

TEST_P(PublishedPosture, PutsTheTipsOnTheBall) {
  const HandModel hand = Hand();
  JointVector q(hand.num_joints());
  int i = 0;
  for (const char* finger : {"first", "middle", "ring", "little", "thumb"})
    for (const int j : hand.fingers[hand.FindFinger(finger)].joints)
      q[j] = GetParam().degrees[i++] * M_PI / 180;
  KinematicsData data;
  ForwardKinematics(hand, q, &data);
  for (int f = 0; f < hand.num_fingers(); ++f) {
    const double gap = (FingertipCentre(hand, data, f) - GetParam().p_WO).norm() - 0.025 -
                       hand.fingers[f].tip_radius;
    // The posture was found for another hand description, whose tip radii differ by 1-2 mm (public
    // models use 7-9 mm for fingers, 9-12 mm for the thumb).
    EXPECT_NEAR(gap, 0, hand.fingers[f].name == "thumb" ? 4e-3 : 2e-3) << hand.fingers[f].name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinematics, PublishedPosture,
    testing::Values(PublishedGrasp{"Tilt45",
                                   {-8.51, 12.01, 78.84, 35.73, -12.48, 5.57,  79.82, 41.56,
                                    15.16, 8.69,  79.45, 29.75, 39.74,  -1.27, -2.20, 25.79,
                                    78.75, 8.14,  62.62, 9.03,  22.12,  48.50},
                                   {.01612, -.06371, .10808}},
                    PublishedGrasp{"Tilt0",
                                   {-8.82, 15.87, 74.33, 35.74, -13.53, 7.08,  80.12, 38.24,
                                    15.62, 9.38,  79.81, 27.17, 37.38,  -4.06, -4.06, 36.39,
                                    79.05, 7.80,  63.03, 9.04,  24.02,  44.61},
                                   {.01537, -.06635, .10848}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace regrasp
