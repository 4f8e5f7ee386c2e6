#include <algorithm>

#include "core/session/session_impl.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kStartStream = 1000;  // random stream of the start posture

}  // namespace

void Session::Impl::Build(std::uint64_t new_seed) {
  seed = new_seed;
  RandomStream start(seed, kStartStream);
  const Scenario& scenario = config.model.scenario;
  JointVector q0 = scenario.q_preshape;
  q_closed = scenario.q_closed;
  for (int j = 0; j < hand.num_joints(); ++j) {
    // The same offset for both, so that the fingers really touch elsewhere.
    const double offset = parameters.start.joint_sigma_rad * start.Normal();
    q0[j] = std::clamp(q0[j] + offset, hand.joints[j].lower, hand.joints[j].upper);
    q_closed[j] = std::clamp(q_closed[j] + offset, hand.joints[j].lower, hand.joints[j].upper);
  }
  Displace(scenario.X_WO.translation(), &start, {&q0, &q_closed});
  Isometry3d X_WO = scenario.X_WO;
  X_WO.translation() += parameters.start.object_sigma_m * start.Normal3();
  world = std::make_unique<World>(hand, *object, config.world, q0, X_WO, seed);
  world->SetStandIn(true);
  world->SetFriction(parameters.object.friction);
  world->SetMass(parameters.object.mass_kg);
  world->SetGravity(parameters.gravity_W);
  world->MeasureStages(measure);
  sensors = std::make_unique<Sensors>(hand, dt, seed);
  sensors->SetNoise(noise);
  judge_sensors = std::make_unique<Sensors>(hand, dt, 0);
  estimator.Reset();
  judge.Reset();
  felt.Reset();
  controller = HybridController(hand, dt);
  grasp = GraspSequence();
  exploration = FingerExploration();
  explore_request = {};
  gait = FingerGait();
  move = ObjectMove();
  regrasp = RegraspRecord();
  monitor = QualityMonitor();
  q_open = q0;
  tick = 0;
  state = SessionState::kIdle;
  job = JobRecord();
  push_until = -1;
  drop_ticks = 0;
  release_tick = -1;
  tasks.resize(hand.fingers.size());
  was_in_contact.fill(false);
  ToPosture(q_open);
  torque = JointVector::Zero(hand.num_joints());
  Sense();
}

void Session::Impl::Displace(const Vector3d& p_WO, RandomStream* random,
                             std::initializer_list<JointVector*> postures) {
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const Vector3d direction = random->Normal3();
    if (parameters.start.displacement_m == 0) continue;
    for (JointVector* q : postures) {
      KinematicsData data;
      ForwardKinematics(hand, *q, &data);
      const Vector3d tip = FingertipCentre(hand, data, i);
      const Vector3d target =
          tip + parameters.start.displacement_m *
                    TangentPart(direction, (tip - p_WO).normalized()).normalized();
      MoveTip(i, target, q);
    }
  }
}

void Session::Impl::MoveTip(int finger, const Vector3d& target, JointVector* q) const {
  KinematicsData data;
  for (int k = 0; k < 20; ++k) {
    ForwardKinematics(hand, *q, &data);
    const Vector3d tip = FingertipCentre(hand, data, finger);
    const FingerJacobian J = PointJacobian(hand, data, finger, tip);
    const Matrix3d JJt = J * J.transpose() + 1e-5 * Matrix3d::Identity();
    const FingerVector dq = J.transpose() * (JJt.inverse() * (target - tip));
    for (std::size_t n = 0; n < hand.fingers[finger].joints.size(); ++n) {
      const int j = hand.fingers[finger].joints[n];
      (*q)[j] = std::clamp((*q)[j] + dq[static_cast<Eigen::Index>(n)], hand.joints[j].lower,
                           hand.joints[j].upper);
    }
  }
}

void Session::Impl::ToPosture(const JointVector& q) {
  for (int i = 0; i < hand.num_fingers(); ++i) {
    const auto& joints = hand.fingers[i].joints;
    tasks[i] = FingerTask();
    tasks[i].q_target.resize(static_cast<Eigen::Index>(joints.size()));
    for (std::size_t k = 0; k < joints.size(); ++k) tasks[i].q_target[k] = q[joints[k]];
  }
}

void Session::Impl::HoldAll() {
  for (FingerTask& task : tasks) {
    if (task.mode == FingerMode::kPosture) continue;  // never took part in the grasp
    task.mode = FingerMode::kHold;
    task.cap = parameters.control.max_normal_force;
    task.grip = parameters.control.grip_force;
  }
}

}  // namespace regrasp
