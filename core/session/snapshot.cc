#include <algorithm>

#include "core/quality/manipulability.h"
#include "core/session/session_impl.h"

namespace regrasp {

FingerRole Session::Impl::RoleOf(int finger) const {
  switch (tasks[finger].mode) {
    case FingerMode::kHold:
    case FingerMode::kTouch:
      return FingerRole::kHold;
    case FingerMode::kSlide:
      return state == SessionState::kExploring || gait.regrasp().phase() == Regrasp::Phase::kExplore
                 ? FingerRole::kExplore
                 : FingerRole::kMove;
    case FingerMode::kReach:
      return FingerRole::kMove;
    case FingerMode::kPosture:
      return FingerRole::kFree;
  }
  return FingerRole::kFree;
}

void Session::Impl::Snapshot(Frame* frame) const {
  Frame& f = *frame;
  f.tick = tick;
  f.time_s = static_cast<double>(tick) * dt;
  f.state_hash = 0;
  f.state = state;
  f.seed = seed;
  f.noise = noise;
  f.stand_in = world->stand_in();
  f.num_fingers = hand.num_fingers();
  const WorldState& truth = world->state();
  const Estimate& e = estimator.estimate();
  f.q_sensed = e.q;
  f.q = truth.q;
  f.qdot = truth.qdot;
  f.torque = truth.torque;
  f.p_WO_sensed = e.p_WO;
  f.q_WO_sensed = e.q_WO;
  f.p_WO = truth.p_WO;
  f.q_WO = truth.q_WO;
  f.v_WO = truth.v_WO;
  f.w_WO = truth.w_WO;
  f.p_WO_reference = controller.wrench().p_ref();
  f.mass_kg = world->mass_kg();
  f.friction = world->friction();
  f.gravity_W = world->gravity_W();
  f.stability = monitor.stability();
  f.contacts.clear();
  for (const ObjectContact& c : truth.contacts)
    f.contacts.push_back({c.link, c.finger, c.p_WC, c.normal_W, c.force_W, c.depth});
  KinematicsData true_kinematics;
  ForwardKinematics(hand, truth.q, &true_kinematics);
  f.fingers.resize(hand.fingers.size());
  for (int i = 0; i < hand.num_fingers(); ++i) {
    FingerFrame& ff = f.fingers[i];
    const FingerEstimate& fe = e.fingers[i];
    ff = FingerFrame();
    ff.role = RoleOf(i);
    ff.in_contact = fe.in_contact;
    ff.p_WC = fe.p_WC;
    ff.normal_W = fe.normal_W;
    ff.force = fe.force;
    ff.f_command_W = controller.commanded_forces()[i];
    ff.manipulability = fe.manipulability;
    ff.load_margin_without = monitor.load_margin_without(i);
    ff.joint_limit_margin = 1e9;
    for (int j : hand.fingers[i].joints)
      ff.joint_limit_margin = std::min({ff.joint_limit_margin, truth.q[j] - hand.joints[j].lower,
                                        hand.joints[j].upper - truth.q[j]});
    ff.true_tip_W = FingertipCentre(hand, true_kinematics, i);
    double weight = 0;
    Vector3d p = Vector3d::Zero(), n = Vector3d::Zero();
    for (const ObjectContact& c : truth.contacts) {
      if (c.finger != i) continue;
      const double w = c.force_W.norm() + 1e-9;
      p += w * c.p_WC;
      n += w * c.normal_W;
      weight += w;
      ff.true_force_W += c.force_W;
    }
    ff.true_contact = weight > 0;
    if (!ff.true_contact) continue;
    ff.true_p_WC = p / weight;
    ff.true_normal_W = n.normalized();
    ff.true_manipulability =
        Manipulability(PointJacobian(hand, true_kinematics, i, ff.true_p_WC)) / kManipulabilityUnit;
  }
  f.exploration = ExplorationFrame();
  const auto phase = exploration.phase();
  if (phase != FingerExploration::Phase::kIdle && phase != FingerExploration::Phase::kDone) {
    ExplorationFrame& x = f.exploration;
    x.active = true;
    x.finger = exploration.request().finger;
    x.criterion = exploration.request().criterion;
    x.on_stability = exploration.on_stability();
    x.cycle = exploration.cycles();
    x.phi = exploration.phi();
    x.gradient_norm = exploration.algorithm().gradient_norm();
    x.epsilon = parameters.exploration.epsilon;
    x.gradient_W = exploration.algorithm().gradient_W();
    x.velocity_W = exploration.algorithm().velocity_W();
  }
  if (state == SessionState::kRotating && gait.regrasp().phase() == Regrasp::Phase::kExplore) {
    ExplorationFrame& x = f.exploration;
    x.active = true;
    x.finger = gait.regrasp().request().finger;
    x.criterion = gait.regrasp().request().criterion;
    x.on_stability = gait.regrasp().on_stability();
    x.cycle = gait.regrasp().algorithm().cycle();
    x.phi = gait.regrasp().phi();
    x.gradient_norm = gait.regrasp().algorithm().gradient_norm();
    x.epsilon = parameters.exploration.epsilon;
    x.gradient_W = gait.regrasp().algorithm().gradient_W();
  }
  f.gait = GaitFrame();
  if (state == SessionState::kRotating) {
    f.gait.active = true;
    f.gait.phase = static_cast<int>(gait.phase());
    f.gait.finger = gait.finger();
    f.gait.target_angle_rad = gait.turned();
    f.gait.achieved_angle_rad = job.rotate.angle_rad;
    f.gait.cycles = gait.cycles();
    f.gait.regrasps = gait.regrasps();
  }
  f.job = job;
}

std::uint64_t Session::Impl::Hash() const {
  StateHasher hasher;
  hasher.Add(tick);
  hasher.Add(seed);
  hasher.Add(state);
  world->AddTo(&hasher);
  sensors->AddTo(&hasher);
  estimator.AddTo(&hasher);
  felt.AddTo(&hasher);
  controller.AddTo(&hasher);
  grasp.AddTo(&hasher);
  exploration.AddTo(&hasher);
  gait.AddTo(&hasher);
  move.AddTo(&hasher);
  monitor.AddTo(&hasher);
  hasher.Add(push_until);
  hasher.Add(release_tick);
  hasher.Add(drop_ticks);
  // Numbers that act later than the tick in which they were given.
  hasher.Add(explore_request.finger);
  hasher.Add(explore_request.criterion);
  hasher.Add(explore_request.estimator);
  hasher.Add(explore_request.seed);
  hasher.Add(explore_request.max_cycles);
  hasher.Add(gait.request().continuous);
  hasher.Add(gait.request().speed_rad_s);
  hasher.Add(gait.request().seed);
  Parameters given = parameters;
  for (const ParameterInfo& info : ParameterTable())
    for (int k = 0; k < info.size; ++k) hasher.Add(info.access(given)[k]);
  return hasher.Digest();
}

}  // namespace regrasp
