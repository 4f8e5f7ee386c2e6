#include "core/world/world.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "core/common/random.h"
#include "core/hand/kinematics.h"
#include "core/world/articulation.h"
#include "core/world/collision.h"
#include "core/world/ode_guard.h"

namespace regrasp {
namespace {

// Joint stops are a spring-damper outside the range [N m/rad, N m s/rad]. With the armature of 2e-4
// kg m² h² k / I = .1 and h d / I = .25: well inside the stability limits of the semi-implicit
// Euler step.
constexpr double kStopStiffness = 20.0;
constexpr double kStopDamping = 0.05;
// Anything faster is a simulation that has exploded [m/s, rad/s].
constexpr double kMaxSpeed = 1e4;

// Found by our own checks, outside ODE: the ODE world is still in order and can be destroyed.
class WorldFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

Vector3d ToVector(const dReal* v) { return {v[0], v[1], v[2]}; }

Matrix3d ToMatrix(const dReal* R) {
  Matrix3d M;
  M << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
  return M;
}

void SetPose(dBodyID body, const Isometry3d& X) {
  dMatrix3 R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) R[4 * r + c] = c < 3 ? X.linear()(r, c) : 0.0;
  dBodySetRotation(body, R);
  dBodySetPosition(body, X.translation().x(), X.translation().y(), X.translation().z());
}

void SetMassOf(dBodyID body, double mass, const Matrix3d& I) {
  dMass m;
  dMassSetParameters(&m, mass, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  dBodySetMass(body, &m);
}

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

struct World::Impl {
  Impl(const HandModel& hand_in, const ObjectModel& object_in, const WorldConfig& config_in,
       const JointVector& q0, const Isometry3d& X_WO0, std::uint64_t seed);
  ~Impl();

  void BuildHand(const JointVector& q0);
  void BuildObject(const Isometry3d& X_WO0);
  void CheckInputs() const;
  void ApplyInputs();
  void ApplyJointTorques();
  Vector3d Preload(const ObjectHit& hit) const;
  void MakeContacts();
  void ApplyJointLoads();
  void UpdateJointLoads();
  void Integrate();
  void ReadState();
  Matrix3d LinkRotation(int link) const;
  Vector3d LinkAngularVelocity(int link) const;

  HandModel hand;
  ObjectModel object;
  WorldConfig config;
  Articulation articulation;
  std::vector<int> finger_of_tip;

  dWorldID world = nullptr;
  dJointGroupID contact_group = nullptr;
  std::vector<dBodyID> bodies;
  std::vector<dJointID> joints;  // joints[i] is articulation.joints[i]
  // What a joint's constraint exerted on its moved body in the last step, at the anchor (and the
  // opposite on the parent). QuickStep starts from it.
  struct JointLoad {
    Vector3d force_W = Vector3d::Zero();
    Vector3d moment_W = Vector3d::Zero();
    Vector3d arm_W = Vector3d::Zero();  // from the moved body's centre of mass to the anchor
    dJointFeedback correction{};
    bool moved_is_first = true;  // in the order of the ODE joint
  };
  std::vector<JointLoad> loads;
  dBodyID object_body = nullptr;
  dJointID stand_in_joint = nullptr;
  std::unique_ptr<Collider> collider;

  // What the caller asked for; handed to ODE at the next step.
  JointVector torque;
  Vector3d push_W = Vector3d::Zero();
  Vector3d gravity_W = Vector3d::Zero();
  double friction = 0;
  double mass = 0;
  bool stand_in = true;
  bool stand_in_applied = false;
  bool mass_applied = false;
  unsigned long random_seed = 0;

  FixedVector<ObjectHit, kMaxObjectContacts> object_hits;
  FixedVector<LinkHit, kMaxLinkHits> link_hits;
  std::array<dJointFeedback, kMaxObjectContacts> feedback{};
  FixedVector<Vector3d, kMaxObjectContacts> preload;  // of object_hits [N]

  WorldState state;
  StageTimes times;
  bool measure = false;
  bool faulted = false;
  bool abandoned = false;  // the fault was inside ODE
  char message[256] = "";
};

World::Impl::Impl(const HandModel& hand_in, const ObjectModel& object_in,
                  const WorldConfig& config_in, const JointVector& q0, const Isometry3d& X_WO0,
                  std::uint64_t seed)
    : hand(hand_in), object(object_in), config(config_in) {
  EnsureOde();
  articulation = PlanBodies(hand, config.merge_universal);
  finger_of_tip.assign(hand.links.size(), -1);
  for (int f = 0; f < hand.num_fingers(); ++f) finger_of_tip[hand.fingers[f].tip_link] = f;
  torque = JointVector::Zero(hand.num_joints());
  friction = object.friction;
  mass = object.mass;
  std::uint64_t mix = seed;
  random_seed = static_cast<unsigned long>(SplitMix64(mix) & 0xffffffffUL);

  world = dWorldCreate();
  dWorldSetQuickStepNumIterations(world, config.iterations);
  dWorldSetQuickStepW(world, config.over_relaxation);
  dWorldSetERP(world, config.joint_erp);
  dWorldSetCFM(world, config.joint_cfm);
  dWorldSetContactMaxCorrectingVel(world, dInfinity);
  dWorldSetAutoDisableFlag(world, 0);
  // Room for every step there will be, so that no step allocates: the exact step needs the square
  // of the number of rows (300 rows with every contact there can be).
  dWorldStepReserveInfo reserve{};
  reserve.struct_size = sizeof(reserve);
  reserve.reserve_factor = 1.5f;
  reserve.reserve_minimum = config.stepper == Stepper::kExact ? 4u << 20 : 1u << 20;
  dWorldSetStepMemoryReservationPolicy(world, &reserve);
  contact_group = dJointGroupCreate(0);

  BuildHand(q0);
  BuildObject(X_WO0);
  state.torque = torque;
  state.q = q0;
  state.qdot = JointVector::Zero(hand.num_joints());
  ReadState();
}

World::Impl::~Impl() {
  if (abandoned) {
    // Destroying a world that ODE has given up on fails again: leave it behind.
    if (collider) collider->Abandon();
    return;
  }
  collider.reset();
  if (contact_group) dJointGroupDestroy(contact_group);
  if (world) dWorldDestroy(world);
}

void World::Impl::BuildHand(const JointVector& q0) {
  KinematicsData kinematics;
  ForwardKinematics(hand, q0, &kinematics);
  std::vector<Isometry3d> X_WL(kinematics.X_WL.begin(),
                               kinematics.X_WL.begin() + static_cast<int>(hand.links.size()));
  for (const BodyPlan& plan : articulation.bodies) {
    dBodyID body = dBodyCreate(world);
    SetMassOf(body, plan.mass, plan.I_B);
    // Gyroscopic torque of a link is below 1e-5 N m at 1 rad/s, and rotors do not add to it.
    dBodySetGyroscopicMode(body, 0);
    SetPose(body, X_WL[plan.link] * Eigen::Translation3d(plan.p_LB));
    bodies.push_back(body);
  }
  for (const JointPlan& plan : articulation.joints) {
    const int parent = articulation.bodies[plan.body].parent;
    const dBodyID parent_body = parent >= 0 ? bodies[parent] : nullptr;
    const Vector3d p = kinematics.p_WJ[plan.first];
    const Vector3d u = kinematics.axis_W[plan.first];
    dJointID joint = nullptr;
    if (plan.second < 0) {
      joint = dJointCreateHinge(world, nullptr);
      dJointAttach(joint, bodies[plan.body], parent_body);
      dJointSetHingeAnchor(joint, p.x(), p.y(), p.z());
      dJointSetHingeAxis(joint, u.x(), u.y(), u.z());
    } else {
      const Vector3d u2 = kinematics.axis_W[plan.second];
      joint = dJointCreateUniversal(world, nullptr);
      dJointAttach(joint, parent_body, bodies[plan.body]);
      dJointSetUniversalAnchor(joint, p.x(), p.y(), p.z());
      dJointSetUniversalAxis1(joint, u.x(), u.y(), u.z());
      dJointSetUniversalAxis2(joint, u2.x(), u2.y(), u2.z());
    }
    joints.push_back(joint);
    JointLoad load;
    load.moved_is_first = plan.second < 0 || parent_body == nullptr;
    loads.push_back(load);
  }
  if (config.stepper == Stepper::kFast && config.warm_start > 0)
    for (std::size_t i = 0; i < joints.size(); ++i)
      dJointSetFeedback(joints[i], &loads[i].correction);
  object_body = dBodyCreate(world);
  collider = std::make_unique<Collider>(hand, articulation, object, bodies, X_WL, object_body);
}

void World::Impl::BuildObject(const Isometry3d& X_WO0) {
  SetPose(object_body, X_WO0);
  SetMassOf(object_body, mass, object.I_OCom);
  mass_applied = true;
  stand_in_joint = dJointCreateFixed(world, nullptr);
}

void World::Impl::CheckInputs() const {
  if (torque.size() != hand.num_joints()) throw WorldFault("wrong number of joint torques");
  if (!torque.allFinite()) throw WorldFault("joint torque is not finite");
  if (!push_W.allFinite()) throw WorldFault("push force is not finite");
  if (!gravity_W.allFinite()) throw WorldFault("gravity is not finite");
  if (!(std::isfinite(mass) && mass > 0)) throw WorldFault("object mass is not positive");
  if (!(std::isfinite(friction) && friction > 0)) throw WorldFault("friction is not positive");
}

void World::Impl::ApplyInputs() {
  dWorldSetGravity(world, gravity_W.x(), gravity_W.y(), gravity_W.z());
  if (!mass_applied) {
    SetMassOf(object_body, mass, object.I_OCom * (mass / object.mass));
    mass_applied = true;
  }
  if (stand_in != stand_in_applied) {
    dJointAttach(stand_in_joint, stand_in ? object_body : nullptr, nullptr);
    if (stand_in) dJointSetFixed(stand_in_joint);
    stand_in_applied = stand_in;
  }
  dBodyAddForce(object_body, push_W.x(), push_W.y(), push_W.z());
}

Matrix3d World::Impl::LinkRotation(int link) const {
  const int b = articulation.body_of_link[link];
  return b >= 0 ? ToMatrix(dBodyGetRotation(bodies[b])) : Matrix3d::Identity();
}

Vector3d World::Impl::LinkAngularVelocity(int link) const {
  const int b = articulation.body_of_link[link];
  return b >= 0 ? ToVector(dBodyGetAngularVel(bodies[b])) : Vector3d::Zero();
}

void World::Impl::ApplyJointTorques() {
  const auto total = [&](int i) {
    const Joint& joint = hand.joints[i];
    const double drive = std::clamp(torque[i], -joint.effort, joint.effort);
    state.torque[i] = drive;
    double stop = 0;
    const double beyond = state.q[i] - std::clamp(state.q[i], joint.lower, joint.upper);
    if (beyond != 0) stop = -kStopStiffness * beyond - kStopDamping * state.qdot[i];
    return drive - joint.damping * state.qdot[i] + stop;
  };
  for (const JointPlan& joint : articulation.joints) {
    const Matrix3d R_WP = LinkRotation(joint.parent_link);
    Vector3d T = total(joint.first) * (R_WP * (joint.R_PJ * joint.axis1_J));
    const dBodyID body = bodies[joint.body];
    if (joint.second >= 0)
      T += total(joint.second) * (ToMatrix(dBodyGetRotation(body)) * joint.axis2_L);
    dBodyAddTorque(body, T.x(), T.y(), T.z());
    const int parent = articulation.bodies[joint.body].parent;
    if (parent >= 0) dBodyAddTorque(bodies[parent], -T.x(), -T.y(), -T.z());
  }
}

// The part of the last step's contact force with this link that goes in as an external force [N].
Vector3d World::Impl::Preload(const ObjectHit& hit) const {
  Vector3d force = Vector3d::Zero();
  int count = 0;
  for (const ObjectContact& contact : state.contacts) {
    if (contact.link != hit.link) continue;
    force += contact.force_W;
    ++count;
  }
  const double normal_force = force.dot(ToVector(hit.geom.normal));
  if (count == 0 || normal_force <= 0) return Vector3d::Zero();
  // Never more than the contact's spring and damper hold now, so that a parting contact lets go at
  // once.
  const dReal* at = hit.geom.pos;
  dVector3 v_object, v_link = {0, 0, 0};
  dBodyGetPointVel(object_body, at[0], at[1], at[2], v_object);
  if (hit.body) dBodyGetPointVel(hit.body, at[0], at[1], at[2], v_link);
  const double parting = ToVector(hit.geom.normal).dot(ToVector(v_object) - ToVector(v_link));
  const double spring = count * std::max(0.0, config.contact_stiffness * hit.geom.depth -
                                                  config.contact_damping * std::max(0.0, parting));
  return std::min(1.0, spring / normal_force) * config.contact_warm_start / count * force;
}

// With the fast stepper most of each contact's last force goes in as an external force, and the
// solver finds the rest, still bounded by "pushes only" and by the friction pyramid: so the total
// stays inside the pyramid.
void World::Impl::MakeContacts() {
  dJointGroupEmpty(contact_group);
  collider->Collide(&object_hits, &link_hits);
  preload.resize(object_hits.size());
  for (Vector3d& f : preload) f.setZero();
  const double hk = config.dt * config.contact_stiffness;
  dContact contact{};
  contact.surface.mode = dContactSoftERP | dContactSoftCFM | dContactApprox1;
  contact.surface.soft_erp = hk / (hk + config.contact_damping);
  contact.surface.soft_cfm = 1.0 / (hk + config.contact_damping);
  contact.surface.mu = friction;
  for (std::size_t i = 0; i < object_hits.size(); ++i) {
    contact.geom = object_hits[i].geom;
    contact.surface.mode &= ~dContactMotionN;
    if (config.stepper == Stepper::kFast) {
      preload[i] = Preload(object_hits[i]);
      const dReal* p = contact.geom.pos;
      const Vector3d& f = preload[i];
      dBodyAddForceAtPos(object_body, f.x(), f.y(), f.z(), p[0], p[1], p[2]);
      if (object_hits[i].body)
        dBodyAddForceAtPos(object_hits[i].body, -f.x(), -f.y(), -f.z(), p[0], p[1], p[2]);
      // The contact's spring has yielded to the part that is there already.
      contact.surface.mode |= dContactMotionN;
      contact.surface.motionN = -contact.surface.soft_cfm * f.dot(ToVector(contact.geom.normal));
    }
    const dJointID joint = dJointCreateContact(world, contact_group, &contact);
    dJointAttach(joint, object_body, object_hits[i].body);
    feedback[i] = dJointFeedback{};
    dJointSetFeedback(joint, &feedback[i]);
  }
  // Links slide on each other without friction: one row in place of three.
  contact.surface.mu = 0;
  for (const LinkHit& hit : link_hits) {
    contact.geom = hit.geom;
    const dJointID joint = dJointCreateContact(world, contact_group, &contact);
    dJointAttach(joint, hit.body_a, hit.body_b);
  }
}

// QuickStep starts every step from zero constraint forces and does not converge in a few
// iterations. So the joint forces of the last step go in as external forces, and the solver finds
// only the change. That is exact for joints, whose rows have no bounds; contacts must start from
// zero. The forces act at the anchor as it is now, and the moments without a part along the joint's
// axes: so they do no work, whatever the joint does. (Forces and torques carried over as they were
// would feed the motion.)
void World::Impl::ApplyJointLoads() {
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const JointPlan& joint = articulation.joints[i];
    const BodyPlan& body = articulation.bodies[joint.body];
    JointLoad& load = loads[i];
    const Matrix3d R_WB = ToMatrix(dBodyGetRotation(bodies[joint.body]));
    const Matrix3d R_WP = LinkRotation(joint.parent_link);
    const Vector3d axis1_W = R_WP * (joint.R_PJ * joint.axis1_J);
    load.arm_W = R_WB * -body.p_LB;
    if (joint.second < 0) {
      load.moment_W -= axis1_W * axis1_W.dot(load.moment_W);
    } else {
      const Vector3d across_W = axis1_W.cross(R_WB * joint.axis2_L).normalized();
      load.moment_W = across_W * across_W.dot(load.moment_W);
    }
    const Vector3d &f = load.force_W, &m = load.moment_W;
    const Vector3d T = m + load.arm_W.cross(f);
    dBodyAddForce(bodies[joint.body], f.x(), f.y(), f.z());
    dBodyAddTorque(bodies[joint.body], T.x(), T.y(), T.z());
    if (body.parent < 0) continue;
    const Vector3d arm_W = R_WP * (hand.joints[joint.first].X_PJ.translation() -
                                   articulation.bodies[body.parent].p_LB);
    const Vector3d T_parent = -m - arm_W.cross(f);
    dBodyAddForce(bodies[body.parent], -f.x(), -f.y(), -f.z());
    dBodyAddTorque(bodies[body.parent], T_parent.x(), T_parent.y(), T_parent.z());
  }
}

void World::Impl::UpdateJointLoads() {
  for (JointLoad& load : loads) {
    const dJointFeedback& change = load.correction;
    const Vector3d f = ToVector(load.moved_is_first ? change.f1 : change.f2);
    const Vector3d T = ToVector(load.moved_is_first ? change.t1 : change.t2);
    load.force_W = config.warm_start * (load.force_W + f);
    load.moment_W = config.warm_start * (load.moment_W + T - load.arm_W.cross(f));
  }
}

void World::Impl::Integrate() {
  if (config.stepper == Stepper::kExact) {
    dWorldStep(world, config.dt);
    return;
  }
  // ODE's generator is global: lend it our own state for the length of the step.
  const unsigned long others = dRandGetSeed();
  dRandSetSeed(random_seed);
  if (config.warm_start > 0) ApplyJointLoads();
  dWorldQuickStep(world, config.dt);
  if (config.warm_start > 0) UpdateJointLoads();
  random_seed = dRandGetSeed();
  dRandSetSeed(others);
}

void World::Impl::ReadState() {
  for (const JointPlan& joint : articulation.joints) {
    const dBodyID body = bodies[joint.body];
    const Matrix3d R_WP = LinkRotation(joint.parent_link);
    const Matrix3d R_WL = ToMatrix(dBodyGetRotation(body));
    const Vector3d w_W =
        ToVector(dBodyGetAngularVel(body)) - LinkAngularVelocity(joint.parent_link);
    double q2 = 0;
    JointAngles(joint, R_WP.transpose() * R_WL, &state.q[joint.first], &q2);
    state.qdot[joint.first] = w_W.dot(R_WP * (joint.R_PJ * joint.axis1_J));
    if (joint.second < 0) continue;
    state.q[joint.second] = q2;
    state.qdot[joint.second] = w_W.dot(R_WL * joint.axis2_L);
  }
  state.p_WO = ToVector(dBodyGetPosition(object_body));
  const dReal* q = dBodyGetQuaternion(object_body);
  state.q_WO = Quaterniond(q[0], q[1], q[2], q[3]);
  state.v_WO = ToVector(dBodyGetLinearVel(object_body));
  state.w_WO = ToVector(dBodyGetAngularVel(object_body));
  state.contacts.clear();
  for (std::size_t i = 0; i < object_hits.size(); ++i) {
    const ObjectHit& hit = object_hits[i];
    ObjectContact contact;
    contact.link = hit.link;
    contact.finger = finger_of_tip[hit.link];
    contact.p_WC = ToVector(hit.geom.pos);
    contact.normal_W = -ToVector(hit.geom.normal);
    contact.force_W = ToVector(feedback[i].f1) + preload[i];
    contact.depth = hit.geom.depth;
    state.contacts.push_back(contact);
  }
  state.link_link_contacts = static_cast<int>(link_hits.size());

  const auto sane = [](double v) { return std::abs(v) < kMaxSpeed; };  // false for NaN
  bool good = state.p_WO.allFinite();
  for (int i = 0; i < hand.num_joints(); ++i) good = good && sane(state.qdot[i]);
  for (int k = 0; k < 3; ++k) good = good && sane(state.v_WO[k]) && sane(state.w_WO[k]);
  if (!good) throw WorldFault("the simulation has diverged");
}

World::World(const HandModel& hand, const ObjectModel& object, const WorldConfig& config,
             const JointVector& q0, const Isometry3d& X_WO0, std::uint64_t seed) {
  if (q0.size() != hand.num_joints() || !q0.allFinite() || !X_WO0.matrix().allFinite())
    throw std::invalid_argument("World: start posture or object pose is malformed");
  impl_ = std::make_unique<Impl>(hand, object, config, q0, X_WO0, seed);
}

World::~World() = default;

void World::SetTorque(const JointVector& torque) { impl_->torque = torque; }
void World::SetStandIn(bool on) { impl_->stand_in = on; }
bool World::stand_in() const { return impl_->stand_in; }
void World::SetPush(const Vector3d& force_W) { impl_->push_W = force_W; }
void World::SetGravity(const Vector3d& gravity_W) { impl_->gravity_W = gravity_W; }
void World::SetFriction(double coefficient) { impl_->friction = coefficient; }
void World::SetMass(double mass_kg) {
  impl_->mass = mass_kg;
  impl_->mass_applied = false;
}

StepStatus World::Step() {
  Impl& w = *impl_;
  if (w.faulted) return StepStatus::kFault;
  try {
    EnsureOde();
    const double t0 = w.measure ? Now() : 0;
    w.CheckInputs();
    w.ApplyInputs();
    w.ApplyJointTorques();
    w.MakeContacts();
    const double t1 = w.measure ? Now() : 0;
    w.Integrate();
    w.ReadState();
    const double t2 = w.measure ? Now() : 0;
    w.times = {t1 - t0, t2 - t1};
    return StepStatus::kOk;
  } catch (const WorldFault& e) {
    std::snprintf(w.message, sizeof(w.message), "%s", e.what());
  } catch (const std::exception& e) {
    w.abandoned = true;
    std::snprintf(w.message, sizeof(w.message), "%s", e.what());
  }
  w.faulted = true;
  return StepStatus::kFault;
}

const char* World::fault_message() const { return impl_->message; }
const WorldState& World::state() const { return impl_->state; }
double World::mass_kg() const { return impl_->mass; }
double World::friction() const { return impl_->friction; }
const Vector3d& World::gravity_W() const { return impl_->gravity_W; }

double World::JointDrift() const {
  const Impl& w = *impl_;
  if (w.faulted) return 0;
  double largest = 0;
  for (std::size_t i = 0; i < w.joints.size(); ++i) {
    dVector3 p1, p2;
    if (w.articulation.joints[i].second < 0) {
      dJointGetHingeAnchor(w.joints[i], p1);
      dJointGetHingeAnchor2(w.joints[i], p2);
    } else {
      dJointGetUniversalAnchor(w.joints[i], p1);
      dJointGetUniversalAnchor2(w.joints[i], p2);
    }
    largest = std::max(largest, (ToVector(p1) - ToVector(p2)).norm());
  }
  return largest;
}

void World::MeasureStages(bool on) { impl_->measure = on; }
World::StageTimes World::stage_times() const { return impl_->times; }

void World::AddTo(StateHasher* hasher) const {
  const Impl& w = *impl_;
  hasher->Add(w.faulted);
  hasher->Add(static_cast<std::uint64_t>(w.random_seed));
  hasher->Add(w.torque);
  hasher->Add(w.push_W);
  hasher->Add(w.gravity_W);
  hasher->Add(w.friction);
  hasher->Add(w.mass);
  hasher->Add(w.stand_in);
  for (const ObjectContact& contact : w.state.contacts) {
    hasher->Add(contact.link);
    hasher->Add(contact.p_WC);
    hasher->Add(contact.normal_W);
    hasher->Add(contact.force_W);
  }
  for (const Impl::JointLoad& load : w.loads) {
    hasher->Add(load.force_W);
    hasher->Add(load.moment_W);
  }
  if (w.faulted) return;  // the bodies belong to an abandoned world
  const auto add_body = [&](dBodyID body) {
    hasher->Add(ToVector(dBodyGetPosition(body)));
    const dReal* q = dBodyGetQuaternion(body);
    for (int k = 0; k < 4; ++k) hasher->Add(q[k]);
    hasher->Add(ToVector(dBodyGetLinearVel(body)));
    hasher->Add(ToVector(dBodyGetAngularVel(body)));
  };
  for (dBodyID body : w.bodies) add_body(body);
  add_body(w.object_body);
}

}  // namespace regrasp
