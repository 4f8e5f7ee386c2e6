#include "core/world/world.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "core/world/articulation.h"
#include "core/world/fast_step.h"
#include "core/world/ode_world.h"
#include "core/world/transmission.h"

namespace regrasp {
namespace {

// Joint stops are a spring-damper outside the range [N m/rad, N m s/rad].
constexpr double kStopStiffness = 20.0;
constexpr double kStopDamping = 0.05;
// Anything faster is a simulation that has exploded [m/s, rad/s].
constexpr double kMaxSpeed = 1e4;
constexpr double kLeastMass = 1e-9;  // [kg]

// Found by our own checks, outside ODE: the ODE world is still in order and can be destroyed.
class WorldFault : public std::runtime_error {
 public:
  explicit WorldFault(const std::string& cause, const char* what_helps = "")
      : std::runtime_error(cause), advice(what_helps) {}
  const char* advice;  ///< what may help, or ""
};

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

struct World::Impl {
  Impl(const HandModel& hand_in, const ObjectModel& object_in, const WorldConfig& config_in,
       const JointVector& q0, const Isometry3d& X_WO0);

  void CheckInputs() const;
  void CheckState() const;
  void UpdateTorques();
  void Show();
  void FindContacts();
  bool MayHave(const ObjectContact& contact) const;
  void Advance();

  ObjectModel object;
  WorldConfig config;
  Transmissions transmissions;
  const HandModel& hand;  // the plant: every joint on its own
  Articulation articulation;
  std::vector<int> finger_of_tip;
  StartOverlap start_overlap;
  OdeWorld ode;
  FastStep fast;

  // What the caller asked for.
  JointVector torque;
  Vector3d push_W = Vector3d::Zero();
  Vector3d gravity_W = Vector3d::Zero();
  double friction = 0;
  double mass = 0;
  bool stand_in = true;

  JointVector joint_torque;   // drive, damping and stop together [N m]
  JointVector joint_damping;  // of joints that need it taken implicitly [N m s/rad]
  std::vector<bool> implicit;
  FixedVector<ObjectHit, kMaxObjectContacts> object_hits;
  FixedVector<LinkHit, kMaxLinkHits> link_hits;
  FixedVector<ObjectContact, kMaxObjectContacts> last_contacts;

  WorldState state;  // of the plant
  WorldState shown;  // with coupled joints: the driven ones only
  StageTimes times;
  bool measure = false;
  bool faulted = false;
  char message[256] = "", cause[256] = "";
};

World::Impl::Impl(const HandModel& hand_in, const ObjectModel& object_in,
                  const WorldConfig& config_in, const JointVector& q0, const Isometry3d& X_WO0)
    : object(object_in),
      config(config_in),
      transmissions(hand_in, kStopStiffness, kStopDamping, config.dt),
      hand(transmissions.plant()),
      articulation(PlanBodies(hand, config.merge_universal)),
      ode(hand, articulation, object, config, transmissions.AnglesToPlant(q0), X_WO0),
      fast(hand, articulation, object, config, transmissions.following()) {
  finger_of_tip.assign(hand.links.size(), -1);
  for (int f = 0; f < hand.num_fingers(); ++f) finger_of_tip[hand.fingers[f].tip_link] = f;
  torque = JointVector::Zero(q0.size());
  joint_torque = joint_damping = JointVector::Zero(hand.num_joints());
  // An explicit damper D and spring K are stable in a semi-implicit Euler step where h² K + 2 h D <
  // 4 I. The armature is a lower bound of I in any posture of any chain. Up to a quarter of the
  // bound they are explicit, beyond it implicit, which is stable for any D and K. The exact step
  // has the armature in its bodies, where a chain resists with less; beside elastic transmissions,
  // which take their part of the bound, all of its joints are implicit.
  const bool all = config.stepper == Stepper::kExact && transmissions.any();
  for (const Joint& joint : hand.joints)
    implicit.push_back(all || config.dt * (joint.damping + kStopDamping) +
                                      config.dt * config.dt * kStopStiffness >
                                  joint.armature);
  friction = object.friction;
  mass = object.mass;
  state.torque = joint_torque;
  state.q = transmissions.AnglesToPlant(q0);
  state.qdot = JointVector::Zero(hand.num_joints());
  state.p_WO = X_WO0.translation();
  state.q_WO = Quaterniond(X_WO0.linear()).normalized();
  const KinematicsData& links = fast.SetPosture(state.q);
  if (config.stepper != Stepper::kExact) ode.SetPoses(links, state);
  const std::vector<Isometry3d> X_WL(
      links.X_WL.begin(), links.X_WL.begin() + static_cast<std::ptrdiff_t>(hand.links.size()));
  start_overlap = DeepestOverlap(hand, X_WL, object, X_WO0);
  Show();
}

void World::Impl::Show() {
  if (!transmissions.any()) return;
  shown = state;
  shown.q = transmissions.FromPlant(state.q);
  shown.qdot = transmissions.FromPlant(state.qdot);
  shown.torque = transmissions.FromPlant(state.torque);
}

void World::Impl::CheckInputs() const {
  if (torque.size() != hand.num_joints() - transmissions.count())
    throw WorldFault("wrong number of joint torques");
  if (!torque.allFinite()) throw WorldFault("joint torque is not finite");
  if (!push_W.allFinite()) throw WorldFault("push force is not finite");
  if (!gravity_W.allFinite()) throw WorldFault("gravity is not finite");
  if (!(std::isfinite(mass) && mass > 0)) throw WorldFault("object mass is not positive");
  // ODE would give up on what comes of these, and leave its world behind for good.
  if (!(mass > kLeastMass)) throw WorldFault("object mass is absurd");
  if (!stand_in && !((push_W / mass + gravity_W).norm() * config.dt < kMaxSpeed))
    throw WorldFault("push force or gravity is absurd");
  if (!(std::isfinite(friction) && friction > 0)) throw WorldFault("friction is not positive");
}

void World::Impl::CheckState() const {
  const auto sane = [](double v) { return std::abs(v) < kMaxSpeed; };  // false for NaN
  bool good = state.p_WO.allFinite() && state.q_WO.coeffs().allFinite();
  for (int i = 0; i < hand.num_joints(); ++i) good = good && sane(state.qdot[i]);
  for (int k = 0; k < 3; ++k) good = good && sane(state.v_WO[k]) && sane(state.w_WO[k]);
  if (!good)
    throw WorldFault("the simulation has diverged",
                     config.stepper != Stepper::kExact
                         ? "try --stepper exact, or a larger armature_kg_m2 in the hand's scenario"
                         : "try --stepper fast, or a larger armature_kg_m2 in the hand's scenario");
}

void World::Impl::UpdateTorques() {
  state.torque = transmissions.ToPlant(torque);
  for (int i = 0; i < hand.num_joints(); ++i) {
    const Joint& joint = hand.joints[i];
    state.torque[i] = std::clamp(state.torque[i], -joint.effort, joint.effort);
    const double beyond = state.q[i] - std::clamp(state.q[i], joint.lower, joint.upper);
    if (implicit[static_cast<std::size_t>(i)]) {
      // - K (x + h qdot') - D qdot' with the rate qdot' after the step.
      joint_torque[i] = state.torque[i] - kStopStiffness * beyond;
      joint_damping[i] = joint.damping;
      if (beyond != 0) joint_damping[i] += kStopDamping + config.dt * kStopStiffness;
      continue;
    }
    joint_torque[i] = state.torque[i] - joint.damping * state.qdot[i];
    if (beyond != 0) joint_torque[i] -= kStopStiffness * beyond + kStopDamping * state.qdot[i];
  }
  if (config.stepper == Stepper::kExact)
    transmissions.AddTorques(state.q, state.qdot, &joint_torque);
}

// The contacts of this step. Each keeps the force that the last step found between the same two
// bodies: a first guess.
void World::Impl::FindContacts() {
  ode.Collide(&object_hits, &link_hits);
  last_contacts = state.contacts;
  state.contacts.clear();
  std::size_t last = 0;
  for (const ObjectHit& hit : object_hits) {
    ObjectContact contact;
    contact.link = hit.link;
    contact.finger = finger_of_tip[hit.link];
    if (contact.finger >= 0 && hit.shape >= hand.fingers[contact.finger].tip_shapes)
      contact.finger = -1;
    for (int k = 0; k < 3; ++k) {
      contact.p_WC[k] = hit.geom.pos[k];
      contact.normal_W[k] = -hit.geom.normal[k];
    }
    contact.depth = hit.geom.depth;
    // Both lists are in the order of the links.
    while (last < last_contacts.size() && last_contacts[last].link < hit.link) ++last;
    if (last < last_contacts.size() && last_contacts[last].link == hit.link)
      contact.force_W = last_contacts[last++].force_W;
    state.contacts.push_back(contact);
  }
  state.link_link_contacts = static_cast<int>(link_hits.size());
}

void World::Impl::Advance() {
  if (config.stepper == Stepper::kExact) {
    ode.Step({joint_torque, joint_damping, push_W, gravity_W, friction, mass, stand_in},
             object_hits, link_hits, &state);
    CheckState();
    return;
  }
  const KinematicsData& links =
      fast.Advance({joint_torque, joint_damping, push_W, gravity_W, friction, mass, stand_in},
                   object_hits, link_hits, &state);
  CheckState();
  ode.SetPoses(links, state);
}

std::string_view Name(Stepper stepper) {
  return stepper == Stepper::kExact ? "exact" : stepper == Stepper::kRound ? "round" : "fast";
}

std::optional<Stepper> StepperNamed(std::string_view name) {
  for (int i = 0; i <= static_cast<int>(kLastStepper); ++i)
    if (name == Name(static_cast<Stepper>(i))) return static_cast<Stepper>(i);
  return std::nullopt;
}

World::World(const HandModel& hand, const ObjectModel& object, const WorldConfig& config,
             const JointVector& q0, const Isometry3d& X_WO0) {
  if (q0.size() != hand.num_joints() || !q0.allFinite() || !X_WO0.matrix().allFinite())
    throw std::invalid_argument("World: start posture or object pose is malformed");
  impl_ = std::make_unique<Impl>(hand, object, config, q0, X_WO0);
}

World::~World() = default;

void World::SetTorque(const JointVector& torque) { impl_->torque = torque; }
void World::SetStandIn(bool on) { impl_->stand_in = on; }
bool World::stand_in() const { return impl_->stand_in; }
void World::SetPush(const Vector3d& force_W) { impl_->push_W = force_W; }
void World::SetGravity(const Vector3d& gravity_W) { impl_->gravity_W = gravity_W; }
void World::SetFriction(double coefficient) { impl_->friction = coefficient; }
void World::SetMass(double mass_kg) { impl_->mass = mass_kg; }

StepStatus World::Step() {
  Impl& w = *impl_;
  if (w.faulted) return StepStatus::kFault;
  try {
    const double t0 = w.measure ? Now() : 0;
    w.CheckInputs();
    w.UpdateTorques();
    w.FindContacts();
    const double t1 = w.measure ? Now() : 0;
    w.Advance();
    w.Show();
    const double t2 = w.measure ? Now() : 0;
    w.times = {t1 - t0, t2 - t1};
    return StepStatus::kOk;
  } catch (const WorldFault& e) {
    std::snprintf(w.cause, sizeof(w.cause), "%s", e.what());
    std::snprintf(w.message, sizeof(w.message), "%s%s%s", e.what(), *e.advice != 0 ? "; " : "",
                  e.advice);
  } catch (const std::exception& e) {
    w.ode.Abandon();
    std::snprintf(w.cause, sizeof(w.cause), "%s", e.what());
    std::snprintf(w.message, sizeof(w.message), "%s", e.what());
  }
  w.faulted = true;
  return StepStatus::kFault;
}

const char* World::fault_message() const { return impl_->message; }
const char* World::fault_cause() const { return impl_->cause; }
const WorldState& World::state() const {
  return impl_->transmissions.any() ? impl_->shown : impl_->state;
}
const StartOverlap& World::start_overlap() const { return impl_->start_overlap; }
double World::mass_kg() const { return impl_->mass; }
double World::friction() const { return impl_->friction; }
const Vector3d& World::gravity_W() const { return impl_->gravity_W; }
double World::JointDrift() const { return impl_->faulted ? 0 : impl_->ode.JointDrift(); }
void World::MeasureStages(bool on) { impl_->measure = on; }
World::StageTimes World::stage_times() const { return impl_->times; }

WorldMemory World::Memory() const {
  const Impl& w = *impl_;
  WorldMemory m{w.faulted,  w.state, w.torque,   w.push_W, w.gravity_W,
                w.friction, w.mass,  w.stand_in, {}};
  if (w.config.stepper == Stepper::kExact && !w.faulted) m.bodies = w.ode.Memory();
  return m;
}

/// Of a link and a finger of this hand.
bool World::Impl::MayHave(const ObjectContact& contact) const {
  if (contact.link < 0 || static_cast<std::size_t>(contact.link) >= finger_of_tip.size())
    return false;
  const int finger = finger_of_tip[static_cast<std::size_t>(contact.link)];
  const auto shapes = hand.links[static_cast<std::size_t>(contact.link)].shapes.size();
  return contact.finger == finger ||
         (contact.finger == -1 &&
          shapes > static_cast<std::size_t>(hand.fingers[finger].tip_shapes));
}

bool World::Remember(const WorldMemory& m) {
  Impl& w = *impl_;
  const auto n = static_cast<Eigen::Index>(w.hand.num_joints());
  const bool exact = w.config.stepper == Stepper::kExact;
  if (w.faulted || m.torque.size() != n - w.transmissions.count() || m.state.q.size() != n ||
      m.state.qdot.size() != n || m.state.torque.size() != n)
    return false;
  for (const ObjectContact& contact : m.state.contacts)
    if (!w.MayHave(contact)) return false;
  if (exact ? !w.ode.Remember(m.bodies) : !m.bodies.bodies.empty()) return false;
  w.state = m.state;
  w.torque = m.torque;
  w.push_W = m.push_W;
  w.gravity_W = m.gravity_W;
  w.friction = m.friction;
  w.mass = m.mass;
  w.stand_in = m.stand_in;
  if (!exact) w.ode.SetPoses(w.fast.SetPosture(w.state.q), w.state);
  w.Show();
  return true;
}

}  // namespace regrasp
