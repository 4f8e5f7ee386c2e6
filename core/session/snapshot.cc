#include <algorithm>

#include "core/quality/manipulability.h"
#include "core/session/session_impl.h"

namespace regrasp {
namespace {

FingerRole RoleOf(FingerMode mode) {
  switch (mode) {
    case FingerMode::kHold:
    case FingerMode::kTouch:
      return FingerRole::kHold;
    case FingerMode::kSlide:
    case FingerMode::kReach:
      return FingerRole::kMove;
    case FingerMode::kPosture:
      return FingerRole::kFree;
  }
  return FingerRole::kFree;
}

}  // namespace

/// `kinematics`: of the truth.
void Session::Impl::RecordFinger(int finger, const KinematicsData& kinematics,
                                 FingerFrame* frame) const {
  const WorldState& truth = world.state();
  const FingerEstimate& estimate = estimator.estimate().fingers[finger];
  FingerFrame& f = *frame;
  f = FingerFrame();
  f.role = RoleOf(tasks[finger].mode);
  f.in_contact = estimate.in_contact;
  f.p_WC = estimate.p_WC;
  f.normal_W = estimate.normal_W;
  f.force = estimate.force;
  f.f_command_W = controller.commanded_forces()[finger];
  f.manipulability = estimate.manipulability;
  f.load_margin_without = monitor.load_margin_without(finger);
  const JointVector& q = estimator.estimate().q;
  f.joint_limit_margin = 1e9;
  for (int j : hand.fingers[finger].joints)
    f.joint_limit_margin =
        std::min({f.joint_limit_margin, q[j] - hand.joints[j].lower, hand.joints[j].upper - q[j]});
  f.true_tip_W = FingertipCentre(hand, kinematics, finger);
  for (const ObjectContact& contact : truth.contacts)
    if (contact.finger == finger) f.true_force_W += contact.force_W;
  const FingertipReading contact = TrueFingertip(truth, finger);
  f.true_contact = contact.in_contact;
  if (!f.true_contact) return;
  f.true_p_WC = contact.p_WC;
  f.true_normal_W = contact.normal_W;
  f.true_manipulability =
      Manipulability(PointJacobian(hand, kinematics, finger, f.true_p_WC)) / kManipulabilityUnit;
}

void Session::Impl::Snapshot(Frame* frame) {
  Frame& f = *frame;
  const WorldState& truth = world.state();
  const Estimate& e = estimator.estimate();
  f.tick = tick;
  f.time_s = static_cast<double>(tick) * dt;
  f.state_hash = 0;
  f.state = state;
  f.seed = seed;
  f.noise = sensors.noise();
  f.stand_in = world.stand_in();
  f.num_fingers = hand.num_fingers();
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
  f.mass_kg = world.mass_kg();
  f.friction = world.friction();
  f.friction_counted = control.friction_estimate;
  f.gravity_W = world.gravity_W();
  f.stability = monitor.stability(Context().now);
  f.contacts.clear();
  for (const ObjectContact& c : truth.contacts)
    f.contacts.push_back({c.link, c.finger, c.p_WC, c.normal_W, c.force_W, c.depth});
  KinematicsData true_kinematics;
  ForwardKinematics(hand, truth.q, &true_kinematics);
  f.fingers.resize(hand.fingers.size());
  for (int i = 0; i < hand.num_fingers(); ++i) RecordFinger(i, true_kinematics, &f.fingers[i]);
  f.exploration = ExplorationFrame();
  f.gait = GaitFrame();
  f.job = job;
  if (const Activity* running = Running(state)) running->Record(Context(), frame);
}

std::uint64_t Session::Impl::Hash() const {
  StateHasher hasher;
  HashFields(*this, &hasher);
  return hasher.Digest();
}

void Session::Impl::Load(std::string_view bytes) {
  FieldLoader loader(bytes, hand.num_fingers());
  Fields(loader);
  loader.Finish();
  if (estimator.estimate().fingers.size() != hand.fingers.size())
    loader.Refuse("estimator", "has not begun");
  if (tasks.size() != hand.fingers.size()) loader.Refuse("tasks", "are of another hand");
  if (Running(state) && !job_running()) loader.Refuse("job", "does not run");
  CountOn();
  log = EventLog();
  finished.clear();
}

}  // namespace regrasp
