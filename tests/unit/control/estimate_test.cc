#include <gtest/gtest.h>

#include <cmath>

#include "core/common/random.h"
#include "core/quality/manipulability.h"
#include "tests/unit/control/held_sphere.h"

namespace regrasp {
namespace {

constexpr double kDt = 1e-3;

class StateEstimatorTest : public ::testing::Test {
 protected:
  const LoadedScenario scenario_ = ShadowHand();
  const HandModel& hand_ = scenario_.hand;
  const JointVector q_ = GraspPosture(hand_);
};

TEST_F(StateEstimatorTest, WithoutFiltersBelievesWhatItSenses) {
  StateEstimator estimator(hand_, kDt);
  RandomStream random(1, 0);
  for (int tick = 0; tick < 50; ++tick) {
    JointVector q = q_;
    for (double& angle : q) angle += 0.05 * random.Normal();
    SensorReading reading = TouchingReading(hand_, q, 0.5 + random.Uniform());
    reading.q_WO = FromRotationVector(0.3 * random.Normal3());
    reading.p_WO += 1e-3 * random.Normal3();
    const Estimate& e = estimator.Update(reading, UnfilteredParameters());
    // Rounding of numbers of order 1.
    EXPECT_LT((e.q - reading.q).norm(), 1e-14);
    EXPECT_LT((e.p_WO - reading.p_WO).norm(), 1e-15);
    EXPECT_LT(RotationVector(e.q_WO * reading.q_WO.conjugate()).norm(), 1e-12);
    for (std::size_t i = 0; i < e.fingers.size(); ++i) {
      const FingerEstimate& f = e.fingers[i];
      const FingertipReading& r = reading.fingertips[i];
      EXPECT_TRUE(f.in_contact);
      EXPECT_LT((f.p_WC - r.p_WC).norm(), 1e-14);
      EXPECT_LT((f.normal_W - r.normal_W).norm(), 1e-14);
      EXPECT_NEAR(f.force, r.force, 1e-15);
      EXPECT_EQ(f.ticks_in_contact, tick + 1);
      EXPECT_DOUBLE_EQ(f.manipulability, Manipulability(f.J) / kManipulabilityUnit);
    }
  }
}

// A first-order low pass with gain a leaves a / (2 - a) of the variance of white noise.
TEST_F(StateEstimatorTest, FiltersReduceTheVarianceAsTheirTimeConstantsSay) {
  constexpr double kSigma = 0.01;
  constexpr int kSamples = 20000;
  const ControlParameters parameters;
  StateEstimator estimator(hand_, kDt);
  RandomStream random(2, 0);
  const SensorReading clean = TouchingReading(hand_, q_, 1.0);
  double joint = 0, pose = 0, force = 0;
  for (int k = -1000; k < kSamples; ++k) {
    SensorReading reading = clean;
    for (double& angle : reading.q) angle += kSigma * random.Normal();
    reading.p_WO += kSigma * random.Normal3();
    for (FingertipReading& r : reading.fingertips) r.force += kSigma * random.Normal();
    const Estimate& e = estimator.Update(reading, parameters);
    if (k < 0) continue;  // 1 s: twenty of the longest time constants
    joint += (e.q - clean.q).squaredNorm() / static_cast<double>(e.q.size());
    pose += (e.p_WO - clean.p_WO).squaredNorm() / 3;
    for (const FingerEstimate& f : e.fingers)
      force += (f.force - 1) * (f.force - 1) / static_cast<double>(e.fingers.size());
  }
  const auto Expected = [&](double time_constant) {
    const double a = kDt / (time_constant + kDt);
    return kSigma * kSigma * a / (2 - a);
  };
  // Relative error of a variance from n samples of correlation time tau: sqrt(2 * 2 tau / n). With
  // 22, 5 and 3 independent channels over 20 s: 1 %, 2 % and 6 %; three times that.
  EXPECT_NEAR(joint / kSamples / Expected(parameters.joint_filter_s), 1, 0.03);
  EXPECT_NEAR(force / kSamples / Expected(parameters.force_filter_s), 1, 0.06);
  EXPECT_NEAR(pose / kSamples / Expected(parameters.pose_filter_s), 1, 0.18);
}

TEST_F(StateEstimatorTest, AFreshContactStartsUnbiased) {
  ControlParameters parameters;
  parameters.contact_from_normal = false;
  StateEstimator estimator(hand_, kDt);
  SensorReading reading = TouchingReading(hand_, q_, 1.0);
  const SensorReading touching = reading;
  for (FingertipReading& r : reading.fingertips) r.in_contact = false;
  for (int k = 0; k < 100; ++k) estimator.Update(reading, parameters);
  const Estimate& e = estimator.Update(touching, parameters);
  // A plain low pass would still be near its old value, 30 ms away.
  for (std::size_t i = 0; i < e.fingers.size(); ++i)
    EXPECT_LT((e.fingers[i].p_WC - touching.fingertips[i].p_WC).norm(), 1e-14);
}

TEST_F(StateEstimatorTest, ALostContactPointTravelsWithTheFingertip) {
  const ControlParameters parameters = UnfilteredParameters();
  StateEstimator estimator(hand_, kDt);
  SensorReading reading = TouchingReading(hand_, q_, 1.0);
  estimator.Update(reading, parameters);
  const int finger = 0, tip = hand_.fingers[finger].tip_link;
  const Vector3d p_L =
      estimator.estimate().kinematics.X_WL[tip].inverse() * reading.fingertips[finger].p_WC;
  reading.fingertips[finger].in_contact = false;
  reading.fingertips[finger].p_WC = Vector3d(9, 9, 9);  // meaningless without contact
  for (double& angle : reading.q) angle += 0.1;
  const Estimate& e = estimator.Update(reading, parameters);
  EXPECT_FALSE(e.fingers[finger].in_contact);
  EXPECT_EQ(e.fingers[finger].ticks_without_contact, 1);
  EXPECT_EQ(e.fingers[finger].force, 0);
  EXPECT_LT((e.fingers[finger].p_WC - e.kinematics.X_WL[tip] * p_L).norm(), 1e-14);
}

TEST_F(StateEstimatorTest, ContactFromNormalLiesOnTheFingertip) {
  ControlParameters parameters = UnfilteredParameters();
  parameters.contact_from_normal = true;
  StateEstimator estimator(hand_, kDt);
  RandomStream random(3, 0);
  const SensorReading clean = TouchingReading(hand_, q_, 1.0);
  for (int k = 0; k < 100; ++k) {
    SensorReading reading = clean;
    for (FingertipReading& r : reading.fingertips) r.p_WC += 1e-3 * random.Normal3();
    const Estimate& e = estimator.Update(reading, parameters);
    for (int i = 0; i < hand_.num_fingers(); ++i) {
      const Finger& finger = hand_.fingers[static_cast<std::size_t>(i)];
      const FingerEstimate& f = e.fingers[static_cast<std::size_t>(i)];
      const Shape& shape = hand_.links[static_cast<std::size_t>(finger.tip_link)].shapes[0];
      const Isometry3d& X_WL = e.kinematics.X_WL[static_cast<std::size_t>(finger.tip_link)];
      const Vector3d a = X_WL * shape.a_L, d = X_WL * shape.b_L - a;
      const double s = std::clamp((f.p_WC - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      // Behind the segment's end the sphere about the end is the surface, beside it the cylinder;
      // a normal that is not at right angles to the axis leaves the cylinder by its cosine.
      EXPECT_LE((f.p_WC - a - s * d).norm(), shape.radius + 1e-12);
      EXPECT_LT((f.p_WC - clean.fingertips[static_cast<std::size_t>(i)].p_WC).norm(), 5e-3);
    }
  }
}

TEST_F(StateEstimatorTest, ObjectScaleIsTheMeanDistanceOfTheContacts) {
  const Estimate e = TouchingEstimate(hand_, q_);
  double sum = 0;
  for (const FingerEstimate& f : e.fingers) sum += (f.p_WC - e.p_WO).norm();
  EXPECT_NEAR(e.object_scale, sum / 5, 1e-15);
}

TEST_F(StateEstimatorTest, GraspOfTakesTheFingersAskedFor) {
  const Estimate e = TouchingEstimate(hand_, q_);
  const Grasp grasp = GraspOf(e, {1, 4}, 0.5);
  ASSERT_EQ(grasp.size(), 2u);
  EXPECT_EQ(grasp[0].position, e.fingers[1].p_WC - e.p_WO);
  EXPECT_EQ(grasp[1].inward_normal, -e.fingers[4].normal_W);
  EXPECT_EQ(grasp[1].mu, 0.5);
}

/// Joint angles by which every fingertip of TouchingReading() moves its contact by `step`.
JointVector Carried(const HandModel& hand, const Estimate& e, const Vector3d& step) {
  JointVector q = e.q;
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const FingerEstimate& f = e.fingers[static_cast<std::size_t>(i)];
    const Eigen::VectorXd dq = f.J.completeOrthogonalDecomposition().solve(step);
    const auto& joints = hand.fingers[static_cast<std::size_t>(i)].joints;
    for (std::size_t j = 0; j < joints.size(); ++j)
      q[joints[j]] += dq[static_cast<Eigen::Index>(j)];
  }
  return q;
}

// A pose sensor of 15 Hz that is 70 ms late and noisy by 5 mm, an object that five fingers carry
// 12 mm along x in 0.6 s: the fingers that hold tell where it is, without them it is believed to
// be where the sensor's mean was.
TEST_F(StateEstimatorTest, TheFingersThatHoldTellHowTheObjectMovesBetweenPoses) {
  ControlParameters parameters = UnfilteredParameters();
  parameters.slow_pose_filter_s = 1.0;
  const FingerSet all = FingerSet::First(hand_.num_fingers());
  for (const bool holding : {true, false}) {
    StateEstimator estimator(hand_, kDt);
    RandomStream random(5, 0);
    SensorReading reading = TouchingReading(hand_, q_, 1.0);
    reading.object_rate_hz = 15;
    const Vector3d start = reading.p_WO;
    Vector3d truth = start;
    std::vector<Vector3d> path;
    std::int64_t object_tick = 0;
    for (int tick = 0; tick < 4600; ++tick) {
      if (tick >= 4000) {
        const Vector3d step(2e-5, 0, 0);
        const Estimate& e = estimator.estimate();
        const JointVector q = Carried(hand_, e, step);
        truth += step;
        reading = TouchingReading(hand_, q, 1.0);
        reading.object_rate_hz = 15;
      }
      path.push_back(truth);
      if (tick % 67 == 0) {
        reading.p_WO =
            path[static_cast<std::size_t>(std::max(0, tick - 67))] + 5e-3 * random.Normal3();
        object_tick = std::max(0, tick - 67);
      } else {
        reading.p_WO = path.front();  // held by a real sensor; not read again in any case
      }
      reading.tick = tick;
      reading.object_tick = object_tick;
      estimator.Update(reading, parameters, holding ? all : FingerSet{});
    }
    const double error = (estimator.estimate().p_WO - truth).norm();
    if (holding) {
      EXPECT_LT(error, 2.5e-3);
    } else {
      EXPECT_GT(error, 5e-3);
    }
  }
}

// On taxels the contact of a fingertip is known better than the taxel's centre, also where the
// ball's centre is believed 8 mm from where it is.
TEST_F(StateEstimatorTest, TaxelsAreNotBelievedToTheirCentres) {
  constexpr double kPitch = 6.6e-3;
  RandomStream random(6, 0);
  double followed = 0, by_centre = 0;
  for (int trial = 0; trial < 50; ++trial) {
    StateEstimator estimator(hand_, kDt);
    JointVector q = q_;
    for (double& angle : q) angle += 0.05 * random.Normal();
    SensorReading reading = TouchingReading(hand_, q, 1.0);
    const SensorReading clean = reading;
    reading.p_WO += 8e-3 * random.Normal3().normalized();
    reading.taxel_pitch_m = kPitch;
    KinematicsData kinematics;
    ForwardKinematics(hand_, reading.q, &kinematics);
    for (int i = 0; i < hand_.num_fingers(); ++i) {
      FingertipReading& r = reading.fingertips[static_cast<std::size_t>(i)];
      const Isometry3d& X_WL = kinematics.X_WL[hand_.fingers[static_cast<std::size_t>(i)].tip_link];
      const auto taxels = MakeTaxels(MakeTipAxes(hand_, i), kPitch);
      const Vector3d p_LC = X_WL.inverse() * r.p_WC;
      const Taxel& taxel = NearestTaxel(taxels, p_LC);
      r.p_WC = X_WL * taxel.p_LT;
      r.normal_W = -(X_WL.linear() * taxel.outward_L);
    }
    const Estimate& e = estimator.Update(reading, ControlParameters());
    for (std::size_t i = 0; i < e.fingers.size(); ++i) {
      followed += (e.fingers[i].normal_W - clean.fingertips[i].normal_W).norm();
      by_centre += (reading.fingertips[i].normal_W - clean.fingertips[i].normal_W).norm();
    }
  }
  EXPECT_LT(followed, 0.6 * by_centre);
}

}  // namespace
}  // namespace regrasp
