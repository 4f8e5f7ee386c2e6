#include "core/control/hybrid_controller.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/common/random.h"
#include "tests/unit/control/held_sphere.h"

namespace regrasp {
namespace {

constexpr double kDt = 1e-3;

class HybridControllerTest : public ::testing::Test {
 protected:
  HybridControllerTest() {
    tasks_.resize(hand_.fingers.size());
    for (FingerTask& task : tasks_) task.mode = FingerMode::kHold;
    parameters_ = UnfilteredParameters();
    parameters_.limit_stiffness = 0;  // joint limits have their own test
  }

  /// Part of the joint torques that belongs to one finger.
  FingerVector OfFinger(const JointVector& torque, int finger) const {
    const auto& joints = hand_.fingers[static_cast<std::size_t>(finger)].joints;
    FingerVector part(static_cast<Eigen::Index>(joints.size()));
    for (std::size_t k = 0; k < joints.size(); ++k)
      part[static_cast<Eigen::Index>(k)] = torque[joints[k]];
    return part;
  }

  /// Potential energy of the links [J].
  double GravityEnergy(const JointVector& q) const {
    KinematicsData kinematics;
    ForwardKinematics(hand_, q, &kinematics);
    double energy = 0;
    for (std::size_t i = 0; i < hand_.links.size(); ++i)
      energy -= hand_.links[i].mass * gravity_.dot(kinematics.X_WL[i] * hand_.links[i].p_LCom);
    return energy;
  }

  const LoadedScenario scenario_ = ShadowHand();
  const HandModel& hand_ = scenario_.hand;
  const JointVector q_ = GraspPosture(hand_);
  const Vector3d gravity_ = GraspGravity();
  ControlParameters parameters_;
  FingerTasks tasks_;
};

// Virtual work: for any small joint motion the drives' work is what the links gain in the field of
// gravity plus what the commanded contact forces do on the object. Neither side knows the other's
// Jacobians: the right one is finite differences of positions.
TEST_F(HybridControllerTest, HoldingTorquesAreInEquilibriumWithTheContactForces) {
  const Estimate e = TouchingEstimate(hand_, q_);
  HybridController controller(hand_, kDt);
  controller.StartHolding(e, gravity_, parameters_);
  const JointVector torque = controller.Update(e, tasks_, {}, gravity_, parameters_);
  constexpr double kStep = 1e-6;
  for (int j = 0; j < hand_.num_joints(); ++j) {
    JointVector plus = q_, minus = q_;
    plus[j] += kStep;
    minus[j] -= kStep;
    KinematicsData at_plus, at_minus;
    ForwardKinematics(hand_, plus, &at_plus);
    ForwardKinematics(hand_, minus, &at_minus);
    double work = GravityEnergy(plus) - GravityEnergy(minus);
    for (int i = 0; i < hand_.num_fingers(); ++i) {
      const auto tip =
          static_cast<std::size_t>(hand_.fingers[static_cast<std::size_t>(i)].tip_link);
      const Vector3d p_L =
          e.kinematics.X_WL[tip].inverse() * e.fingers[static_cast<std::size_t>(i)].p_WC;
      work += controller.commanded_forces()[static_cast<std::size_t>(i)].dot(
          at_plus.X_WL[tip] * p_L - at_minus.X_WL[tip] * p_L);
    }
    // Central differences of lengths of 0.1 m at forces of 1 N: rounding 1e-16 / 1e-6, error of
    // second order 1e-12.
    EXPECT_NEAR(torque[j], work / (2 * kStep), 1e-9)
        << hand_.joints[static_cast<std::size_t>(j)].name;
  }
}

TEST_F(HybridControllerTest, HoldingForcesAddUpToTheWantedWrench) {
  const Estimate e = TouchingEstimate(hand_, q_);
  HybridController controller(hand_, kDt);
  controller.StartHolding(e, gravity_, parameters_);
  for (int k = 0; k < 100; ++k) controller.Update(e, tasks_, {}, gravity_, parameters_);
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();
  for (std::size_t i = 0; i < e.fingers.size(); ++i) {
    force += controller.commanded_forces()[i];
    torque += (e.fingers[i].p_WC - e.p_WO).cross(controller.commanded_forces()[i]);
  }
  const Vector3d e_f = force - controller.wrench().force();
  const Vector3d e_t = (torque - controller.wrench().torque()) / e.object_scale;
  EXPECT_NEAR(std::hypot(e_f.norm(), e_t.norm()), controller.qp_residual(), 1e-12);
  // This posture can hold the object (see grasp_posture.h): the preference for the grip force costs
  // at most a tenth of the weight, the limit at which integration stops.
  EXPECT_LT(controller.qp_residual(), parameters_.residual_limit);
}

// Joint torques tau press on the object with the force f that solves min |Jᵀ f - tau|.
TEST_F(HybridControllerTest, PostureSpringsGiveNoContactForce) {
  const Estimate rest = TouchingEstimate(hand_, q_);
  JointVector moved = q_;
  RandomStream random(1, 0);
  for (double& angle : moved) angle += 0.2 * random.Normal();
  const Estimate e = TouchingEstimate(hand_, moved);
  for (FingerTask& task : tasks_) {
    task.mode = FingerMode::kTouch;
    task.force = 0;
  }
  parameters_.posture_stiffness = 0.5;
  for (const double lambda : {1e-6, 0.004}) {
    parameters_.projection_damping = lambda;
    HybridController controller(hand_, kDt);
    controller.StartHolding(rest, gravity_, parameters_);
    const JointVector torque = controller.Update(e, tasks_, {}, gravity_, parameters_) -
                               GravityTorque(hand_, e.kinematics, gravity_);
    for (int i = 0; i < hand_.num_fingers(); ++i) {
      const FingerJacobian& J = e.fingers[static_cast<std::size_t>(i)].J;
      const FingerVector tau = OfFinger(torque, i);
      const FingerVector spring = OfFinger(parameters_.posture_stiffness * (q_ - moved), i);
      const Matrix3d JJt = J * J.transpose();
      const Vector3d force = JJt.inverse() * (J * tau);
      const Vector3d undamped = JJt.inverse() * (J * spring);
      EXPECT_GT(undamped.norm(), 0.01);  // without the projection the springs would press
      // Damping lets through lambda² / (sigma² + lambda²) of it, sigma: singular values of J.
      const double sigma2 = Eigen::SelfAdjointEigenSolver<Matrix3d>(JJt).eigenvalues()[0];
      EXPECT_LE(force.norm(), lambda * lambda / (sigma2 + lambda * lambda) * undamped.norm() + 1e-9)
          << hand_.fingers[static_cast<std::size_t>(i)].name << ", lambda " << lambda;
      if (J.cols() > 3) {
        EXPECT_GT(tau.norm(), 0) << "no null space left for the posture";
      }
    }
  }
}

// Fingers where the Jacobian has a singular value of a few mm, as the thumb at the edge of its
// workspace: with a projection next to undamped what they press with is what they are asked for,
// however far they are from their resting posture.
TEST_F(HybridControllerTest, UndampedForceIsWhatIsAskedForNearASingularPosture) {
  parameters_.projection_damping = 1e-4;
  for (FingerTask& task : tasks_) {
    task.mode = FingerMode::kTouch;
    task.force = 1;
  }
  RandomStream random(7, 0);
  int near_singular = 0, of_thumb = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    JointVector moved(hand_.num_joints());
    for (int j = 0; j < hand_.num_joints(); ++j) {
      const Joint& joint = hand_.joints[static_cast<std::size_t>(j)];
      moved[j] = joint.lower + random.Uniform() * (joint.upper - joint.lower);
    }
    const Estimate e = TouchingEstimate(hand_, moved);
    HybridController controller(hand_, kDt);
    controller.StartHolding(TouchingEstimate(hand_, q_), gravity_, parameters_);
    const JointVector torque = controller.Update(e, tasks_, {}, gravity_, parameters_) -
                               GravityTorque(hand_, e.kinematics, gravity_);
    for (int i = 0; i < hand_.num_fingers(); ++i) {
      const FingerJacobian& J = e.fingers[static_cast<std::size_t>(i)].J;
      const Matrix3d JJt = J * J.transpose();
      const double sigma = std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(JJt).eigenvalues()[0]);
      if (sigma < 0.005 || sigma > 0.012) continue;
      ++near_singular;
      of_thumb += i == hand_.num_fingers() - 1;
      const Vector3d force = JJt.inverse() * (J * OfFinger(torque, i));
      const Vector3d asked = -e.fingers[static_cast<std::size_t>(i)].normal_W;
      EXPECT_LT((force - asked).norm(), 0.05)
          << hand_.fingers[static_cast<std::size_t>(i)].name << ", sigma " << sigma;
    }
  }
  EXPECT_GT(near_singular, 100);
  EXPECT_GT(of_thumb, 10);
}

TEST_F(HybridControllerTest, LimitSpringsPushBackIntoTheRange) {
  parameters_.limit_stiffness = 1;
  parameters_.projection_damping = 1e3;  // no projection: the springs alone
  for (FingerTask& task : tasks_) {
    task.mode = FingerMode::kTouch;
    task.force = 0;
  }
  for (int side = 0; side < 2; ++side) {
    JointVector q(hand_.num_joints());
    for (int j = 0; j < hand_.num_joints(); ++j) {
      const Joint& joint = hand_.joints[static_cast<std::size_t>(j)];
      q[j] = side ? joint.upper : joint.lower;
    }
    const Estimate e = TouchingEstimate(hand_, q);
    HybridController controller(hand_, kDt);
    controller.StartHolding(e, gravity_, parameters_);
    const JointVector torque = controller.Update(e, tasks_, {}, gravity_, parameters_) -
                               GravityTorque(hand_, e.kinematics, gravity_);
    for (int j = 0; j < hand_.num_joints(); ++j)
      EXPECT_NEAR(torque[j], (side ? -1 : 1) * parameters_.limit_margin, 1e-3)
          << hand_.joints[static_cast<std::size_t>(j)].name;  // 1e-3: J J⁺ at this damping, 1e-8
  }
}

TEST_F(HybridControllerTest, SlidingFingerPushesAlongItsMotionAndPressesWithItsForce) {
  const Estimate e = TouchingEstimate(hand_, q_);
  RandomStream random(2, 0);
  for (int i = 0; i < hand_.num_fingers(); ++i) {
    const FingerEstimate& f = e.fingers[static_cast<std::size_t>(i)];
    FingerTask& task = tasks_[static_cast<std::size_t>(i)];
    task.mode = FingerMode::kSlide;
    task.force = f.force;  // on target: no integral
    task.v_W = 0.01 * TangentPart(random.Normal3(), f.normal_W).normalized();
    HybridController controller(hand_, kDt);
    controller.StartHolding(e, gravity_, parameters_);
    controller.Update(e, tasks_, {}, gravity_, parameters_);
    const Vector3d& force = controller.commanded_forces()[static_cast<std::size_t>(i)];
    EXPECT_NEAR(force.dot(f.normal_W), -task.force, 1e-12);  // inwards: against the outward normal
    const Vector3d tangential = TangentPart(force, f.normal_W);
    EXPECT_NEAR(tangential.normalized().dot(task.v_W.normalized()), 1, 1e-9);
    EXPECT_LE(tangential.norm(), parameters_.slide_friction_share * task.force +
                                     parameters_.slide_force_limit + 1e-12);
    task = FingerTask();
    task.mode = FingerMode::kHold;
  }
}

TEST_F(HybridControllerTest, SlidingSpringIsLimitedHoweverLongTheFingerIsStuck) {
  const Estimate e = TouchingEstimate(hand_, q_);
  FingerTask& task = tasks_[2];
  task.mode = FingerMode::kSlide;
  task.force = 0.4;
  task.v_W = 0.015 * TangentPart(Vector3d(1, 2, 3), e.fingers[2].normal_W).normalized();
  HybridController controller(hand_, kDt);
  controller.StartHolding(e, gravity_, parameters_);
  for (int k = 0; k < 5000; ++k) {
    controller.Update(e, tasks_, {}, gravity_, parameters_);
    const Vector3d& force = controller.commanded_forces()[2];
    ASSERT_LE(
        TangentPart(force, e.fingers[2].normal_W).norm(),
        parameters_.slide_friction_share * task.force + parameters_.slide_force_limit + 1e-12);
    // The sensed force stays at 1 N, above the target: the integral comes down to its limit.
    ASSERT_GE(-force.dot(e.fingers[2].normal_W), 0.5 * task.force - 1e-12);
  }
}

// What a sliding finger does to the object is taken off the wrench that the others are asked for.
TEST_F(HybridControllerTest, HoldingFingersCarryWhatTheSlidingFingerPresses) {
  const Estimate e = TouchingEstimate(hand_, q_);
  tasks_[1].mode = FingerMode::kSlide;
  tasks_[1].force = 0.3;
  HybridController controller(hand_, kDt);
  controller.StartHolding(e, gravity_, parameters_);
  for (int k = 0; k < 100; ++k) controller.Update(e, tasks_, {}, gravity_, parameters_);
  Vector3d force = -tasks_[1].force * e.fingers[1].normal_W;
  for (std::size_t i = 0; i < e.fingers.size(); ++i)
    if (i != 1) force += controller.commanded_forces()[i];
  EXPECT_LE((force - controller.wrench().force()).norm(), controller.qp_residual() + 1e-9);
}

TEST_F(HybridControllerTest, AHoldingFingerThatLostContactMovesIn) {
  StateEstimator estimator(hand_, kDt);
  SensorReading reading = TouchingReading(hand_, q_, 1.0);
  HybridController controller(hand_, kDt);
  controller.StartHolding(estimator.Update(reading, parameters_), gravity_, parameters_);
  reading.fingertips[3].in_contact = false;
  const int delay = static_cast<int>(parameters_.reapproach_delay_s / kDt);
  for (int k = 0; k < delay + 2; ++k)
    controller.Update(estimator.Update(reading, parameters_), tasks_, {}, gravity_, parameters_);
  const FingerEstimate& lost = estimator.estimate().fingers[3];
  EXPECT_LT(
      (controller.commanded_forces()[3] + parameters_.reapproach_force * lost.normal_W).norm(),
      1e-12);
}

TEST_F(HybridControllerTest, PostureAndReachAreSprings) {
  const Estimate e = TouchingEstimate(hand_, q_);
  const JointVector gravity_torque = GravityTorque(hand_, e.kinematics, gravity_);
  for (int i = 0; i < hand_.num_fingers(); ++i) {
    FingerTask& task = tasks_[static_cast<std::size_t>(i)];
    task.mode = FingerMode::kPosture;
    task.q_target = OfFinger(q_, i);
    task.q_target.array() += 0.1;
  }
  tasks_[0].mode = FingerMode::kReach;
  tasks_[0].p_target_W = e.fingers[0].p_WF + Vector3d(0.001, 0, 0);
  parameters_.posture_stiffness = 0;
  HybridController controller(hand_, kDt);
  const JointVector torque =
      controller.Update(e, tasks_, {}, gravity_, parameters_) - gravity_torque;
  const FingerVector reach =
      e.fingers[0].J.transpose() * Vector3d(0.001 * parameters_.slide_stiffness, 0, 0);
  EXPECT_LT((OfFinger(torque, 0) - reach).norm(), 1e-12);
  for (int i = 1; i < hand_.num_fingers(); ++i)
    EXPECT_LT((OfFinger(torque, i).array() - 0.1 * parameters_.free_stiffness).matrix().norm(),
              1e-12);
}

// Whatever the sensors say, within what sensors can say, the torques are finite: postures anywhere
// in the joints' range (stretched fingers are singular), contacts anywhere, or none, any mode.
TEST_F(HybridControllerTest, NeverMakesNaN) {
  RandomStream random(4, 0);
  parameters_.limit_stiffness = 1;
  StateEstimator estimator(hand_, kDt);
  HybridController controller(hand_, kDt);
  for (int trial = 0; trial < 5000; ++trial) {
    if (trial % 20 == 0) {
      estimator.Reset();
      controller = HybridController(hand_, kDt);
    }
    SensorReading reading;
    reading.q.resize(hand_.num_joints());
    for (int j = 0; j < hand_.num_joints(); ++j) {
      const Joint& joint = hand_.joints[static_cast<std::size_t>(j)];
      const double pick = random.Uniform();
      const double s = pick < 0.2 ? 0.0 : pick < 0.4 ? 1.0 : random.Uniform();
      reading.q[j] = joint.lower + s * (joint.upper - joint.lower);
    }
    reading.p_WO = 0.1 * random.Normal3();
    reading.q_WO = FromRotationVector(3 * random.Normal3());
    tasks_.resize(hand_.fingers.size());
    for (std::size_t i = 0; i < hand_.fingers.size(); ++i) {
      FingertipReading r;
      r.in_contact = random.Uniform() < 0.6;
      r.p_WC = random.Uniform() < 0.1 ? reading.p_WO : Vector3d(0.1 * random.Normal3());
      r.normal_W =
          random.Uniform() < 0.1 ? Vector3d(-Vector3d::UnitX()) : random.Normal3().normalized();
      r.force = 10 * random.Uniform() * random.Uniform();
      reading.fingertips.push_back(r);
      FingerTask& task = tasks_[i];
      task.mode = static_cast<FingerMode>(static_cast<int>(5 * random.Uniform()));
      task.q_target = FingerVector::Constant(
          static_cast<Eigen::Index>(hand_.fingers[i].joints.size()), random.Normal());
      task.force = random.Uniform() < 0.2 ? 0.0 : 2 * random.Uniform();
      task.cap = random.Uniform() < 0.2 ? 0.0 : 4 * random.Uniform();
      task.grip = 2 * random.Uniform();
      task.v_W = random.Uniform() < 0.5 ? Vector3d(0, 0, 0) : Vector3d(0.02 * random.Normal3());
      task.p_target_W = random.Normal3();
    }
    const Estimate& e = estimator.Update(reading, trial % 2 ? parameters_ : ControlParameters());
    if (trial % 20 == 0) controller.StartHolding(e, gravity_, parameters_);
    const ObjectMotion motion{0.01 * random.Normal3(), 0.2 * random.Normal3()};
    const JointVector& torque = controller.Update(e, tasks_, motion, gravity_, parameters_);
    ASSERT_TRUE(torque.allFinite()) << "trial " << trial;
    // 10 N at the end of a hand of 0.2 m, springs of a few N m/rad: more means a singular inverse.
    ASSERT_LT(torque.cwiseAbs().maxCoeff(), 50) << "trial " << trial;
  }
}

}  // namespace
}  // namespace regrasp
