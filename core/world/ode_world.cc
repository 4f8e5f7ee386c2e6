#include "core/world/ode_world.h"

#include <algorithm>

#include "core/world/ode_guard.h"

namespace regrasp {
namespace {

Vector3d ToVector(const dReal* v) { return {v[0], v[1], v[2]}; }

Matrix3d ToMatrix(const dReal* R) {
  Matrix3d M;
  M << R[0], R[1], R[2], R[4], R[5], R[6], R[8], R[9], R[10];
  return M;
}

void SetPose(dBodyID body, const Matrix3d& R_WB, const Vector3d& p_WB) {
  dMatrix3 R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) R[4 * r + c] = c < 3 ? R_WB(r, c) : 0.0;
  dBodySetRotation(body, R);
  dBodySetPosition(body, p_WB.x(), p_WB.y(), p_WB.z());
}

void SetMassOf(dBodyID body, double mass, const Matrix3d& I) {
  dMass m;
  dMassSetParameters(&m, mass, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  dBodySetMass(body, &m);
}

BodyMemory::Body ReadBody(dBodyID body) {
  const dReal* q = dBodyGetQuaternion(body);
  return {ToVector(dBodyGetPosition(body)),
          {q[0], q[1], q[2], q[3]},
          ToMatrix(dBodyGetRotation(body)),
          ToVector(dBodyGetLinearVel(body)),
          ToVector(dBodyGetAngularVel(body))};
}

/// To the last bit: ODE's own setters normalise what has been normalised before.
void WriteBody(dBodyID body, const BodyMemory::Body& m) {
  dBodySetPosition(body, m.p_W.x(), m.p_W.y(), m.p_W.z());  // also tells its shapes
  dBodySetLinearVel(body, m.v_W.x(), m.v_W.y(), m.v_W.z());
  dBodySetAngularVel(body, m.w_W.x(), m.w_W.y(), m.w_W.z());
  auto* q = const_cast<dReal*>(dBodyGetQuaternion(body));
  for (int k = 0; k < 4; ++k) q[k] = m.wxyz[k];
  auto* R = const_cast<dReal*>(dBodyGetRotation(body));
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) R[4 * r + c] = m.R_WB(r, c);
}

/// Each call, dJointSetUniversalAnchor too, has ODE turn one axis onto the other, which it cannot
/// where they are one line: as they may be before the second is told.
void SetUniversalAxes(dJointID joint, const Vector3d& u1, const Vector3d& u2) {
  dVector3 other;
  dJointGetUniversalAxis2(joint, other);
  if (const Vector3d aside = u1 + u2; u1.cross(ToVector(other)).norm() < 0.1) {
    dJointSetUniversalAxis1(joint, aside.x(), aside.y(), aside.z());
    dJointSetUniversalAxis2(joint, u2.x(), u2.y(), u2.z());
  }
  dJointSetUniversalAxis1(joint, u1.x(), u1.y(), u1.z());
  dJointSetUniversalAxis2(joint, u2.x(), u2.y(), u2.z());
}

}  // namespace

OdeWorld::OdeWorld(const HandModel& hand, const Articulation& articulation,
                   const ObjectModel& object, const WorldConfig& config, const JointVector& q0,
                   const Isometry3d& X_WO0)
    : hand_(hand), articulation_(articulation), object_(object), config_(config) {
  EnsureOde();
  world_ = dWorldCreate();
  dWorldSetERP(world_, config.joint_erp);
  dWorldSetCFM(world_, config.joint_cfm);
  dWorldSetContactMaxCorrectingVel(world_, dInfinity);
  dWorldSetAutoDisableFlag(world_, 0);
  if (config.stepper == Stepper::kExact) {
    // Room for every step there will be, so that no step allocates: the exact step needs the square
    // of the number of rows (300 rows with every contact there can be).
    dWorldStepReserveInfo reserve{};
    reserve.struct_size = sizeof(reserve);
    reserve.reserve_factor = 1.5f;
    reserve.reserve_minimum = 4u << 20;
    dWorldSetStepMemoryReservationPolicy(world_, &reserve);
  }
  // Of its own: the one that all worlds share by default is not for worlds that step in two
  // threads.
  threading_ = dThreadingAllocateSelfThreadedImplementation();
  dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_),
                                       threading_);
  contact_group_ = dJointGroupCreate(0);
  BuildHand(q0);
  BuildObject(X_WO0);
}

OdeWorld::~OdeWorld() {
  // Destroying a world that ODE has given up on fails again: leave it behind.
  if (!world_) return;
  collider_.reset();
  dJointGroupDestroy(contact_group_);
  dWorldDestroy(world_);
  dThreadingFreeImplementation(threading_);
}

void OdeWorld::Abandon() {
  world_ = nullptr;
  collider_->Abandon();
}

void OdeWorld::BuildHand(const JointVector& q0) {
  KinematicsData kinematics;
  ForwardKinematics(hand_, q0, &kinematics);
  std::vector<Isometry3d> X_WL(kinematics.X_WL.begin(),
                               kinematics.X_WL.begin() + static_cast<int>(hand_.links.size()));
  for (const BodyPlan& plan : articulation_.bodies) {
    dBodyID body = dBodyCreate(world_);
    SetMassOf(body, plan.mass, plan.I_B);
    // Gyroscopic torque of a link is below 1e-5 N m at 1 rad/s, and rotors do not add to it.
    dBodySetGyroscopicMode(body, 0);
    bodies_.push_back(body);
  }
  // Attached while the bodies are unturned: the axes that a joint has by default are square then.
  for (const JointPlan& plan : articulation_.joints) {
    const int parent = articulation_.bodies[plan.body].parent;
    const dBodyID parent_body = parent >= 0 ? bodies_[parent] : nullptr;
    if (plan.second < 0) {
      joints_.push_back(dJointCreateHinge(world_, nullptr));
      dJointAttach(joints_.back(), bodies_[plan.body], parent_body);
    } else {
      joints_.push_back(dJointCreateUniversal(world_, nullptr));
      dJointAttach(joints_.back(), parent_body, bodies_[plan.body]);
    }
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodyPlan& plan = articulation_.bodies[b];
    SetPose(bodies_[b], X_WL[plan.link].linear(), X_WL[plan.link] * plan.p_LB);
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointPlan& plan = articulation_.joints[j];
    const Vector3d p = kinematics.p_WJ[plan.first];
    const Vector3d u = kinematics.axis_W[plan.first];
    if (plan.second < 0) {
      dJointSetHingeAnchor(joints_[j], p.x(), p.y(), p.z());
      dJointSetHingeAxis(joints_[j], u.x(), u.y(), u.z());
    } else {
      SetUniversalAxes(joints_[j], u, kinematics.axis_W[plan.second]);
      dJointSetUniversalAnchor(joints_[j], p.x(), p.y(), p.z());
    }
  }
  object_body_ = dBodyCreate(world_);
  collider_ =
      std::make_unique<Collider>(hand_, articulation_, object_, bodies_, X_WL, object_body_);
}

void OdeWorld::BuildObject(const Isometry3d& X_WO0) {
  SetPose(object_body_, X_WO0.linear(), X_WO0.translation());
  mass_ = object_.mass;
  SetMassOf(object_body_, mass_, object_.I_OCom);
  stand_in_joint_ = dJointCreateFixed(world_, nullptr);
}

void OdeWorld::Collide(FixedVector<ObjectHit, kMaxObjectContacts>* object_hits,
                       FixedVector<LinkHit, kMaxLinkHits>* link_hits) {
  EnsureOde();
  collider_->Collide(object_hits, link_hits);
}

void OdeWorld::SetPoses(const KinematicsData& links, const WorldState& object) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodyPlan& plan = articulation_.bodies[b];
    const Isometry3d& X_WL = links.X_WL[plan.link];
    SetPose(bodies_[b], X_WL.linear(), X_WL * plan.p_LB);
  }
  SetPose(object_body_, object.q_WO.toRotationMatrix(), object.p_WO);
}

Matrix3d OdeWorld::LinkRotation(int link) const {
  const int b = articulation_.body_of_link[link];
  return b >= 0 ? ToMatrix(dBodyGetRotation(bodies_[b])) : Matrix3d::Identity();
}

Vector3d OdeWorld::LinkAngularVelocity(int link) const {
  const int b = articulation_.body_of_link[link];
  return b >= 0 ? ToVector(dBodyGetAngularVel(bodies_[b])) : Vector3d::Zero();
}

/// The stand-in takes the object where it is, or lets go.
void OdeWorld::Hold(bool on) {
  dJointAttach(stand_in_joint_, on ? object_body_ : nullptr, nullptr);
  if (on) {
    dJointSetFixed(stand_in_joint_);
    held_at_ = ReadBody(object_body_);
  }
  held_ = on;
}

/// A motor that holds rate 0 with an unbounded torque and the softness 1 / D is a damper D.
void OdeWorld::SetDamping(const JointVector& damping) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const JointPlan& plan = articulation_.joints[i];
    const auto set = [&](int joint, int group) {
      const double D = damping[joint];
      const dReal most = D > 0 ? dInfinity : 0;
      const dReal softness = D > 0 ? 1 / D : config_.joint_cfm;
      const auto param = plan.second < 0 ? dJointSetHingeParam : dJointSetUniversalParam;
      param(joints_[i], dParamFMax + group, most);
      param(joints_[i], dParamCFM + group, softness);
    };
    set(plan.first, 0);
    if (plan.second >= 0) set(plan.second, dParamGroup);
  }
}

void OdeWorld::ApplyLoad(const Load& load) {
  SetDamping(load.damping);
  dWorldSetGravity(world_, load.gravity_W.x(), load.gravity_W.y(), load.gravity_W.z());
  if (mass_ != load.mass) {
    mass_ = load.mass;
    SetMassOf(object_body_, mass_, object_.I_OCom * (mass_ / object_.mass));
  }
  if (load.held != held_) Hold(load.held);
  dBodyAddForce(object_body_, load.push_W.x(), load.push_W.y(), load.push_W.z());
  for (const JointPlan& joint : articulation_.joints) {
    const Matrix3d R_WP = LinkRotation(joint.parent_link);
    Vector3d T = load.torque[joint.first] * (R_WP * (joint.R_PJ * joint.axis1_J));
    const dBodyID body = bodies_[joint.body];
    if (joint.second >= 0)
      T += load.torque[joint.second] * (ToMatrix(dBodyGetRotation(body)) * joint.axis2_L);
    dBodyAddTorque(body, T.x(), T.y(), T.z());
    const int parent = articulation_.bodies[joint.body].parent;
    if (parent >= 0) dBodyAddTorque(bodies_[parent], -T.x(), -T.y(), -T.z());
  }
}

void OdeWorld::MakeContacts(const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
                            const FixedVector<LinkHit, kMaxLinkHits>& link_hits, double friction) {
  dJointGroupEmpty(contact_group_);
  const double hk = config_.dt * config_.contact_stiffness;
  dContact contact{};
  contact.surface.mode = dContactSoftERP | dContactSoftCFM | dContactApprox1;
  contact.surface.soft_erp = hk / (hk + config_.contact_damping);
  contact.surface.soft_cfm = 1.0 / (hk + config_.contact_damping);
  contact.surface.mu = friction;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    contact.geom = hits[i].geom;
    const dJointID joint = dJointCreateContact(world_, contact_group_, &contact);
    dJointAttach(joint, object_body_, hits[i].body);
    feedback_[i] = dJointFeedback{};
    dJointSetFeedback(joint, &feedback_[i]);
  }
  // Links slide on each other without friction: one row in place of three.
  contact.surface.mu = 0;
  for (const LinkHit& hit : link_hits) {
    contact.geom = hit.geom;
    const dJointID joint = dJointCreateContact(world_, contact_group_, &contact);
    dJointAttach(joint, hit.body_a, hit.body_b);
  }
}

void OdeWorld::Step(const Load& load, const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
                    const FixedVector<LinkHit, kMaxLinkHits>& link_hits, WorldState* state) {
  ApplyLoad(load);
  MakeContacts(hits, link_hits, load.friction);
  dWorldStep(world_, config_.dt);
  Read(state);
  for (std::size_t i = 0; i < hits.size(); ++i)
    state->contacts[i].force_W = ToVector(feedback_[i].f1);
}

void OdeWorld::Read(WorldState* state) const {
  for (const JointPlan& joint : articulation_.joints) {
    const dBodyID body = bodies_[joint.body];
    const Matrix3d R_WP = LinkRotation(joint.parent_link);
    const Matrix3d R_WL = ToMatrix(dBodyGetRotation(body));
    const Vector3d w_W =
        ToVector(dBodyGetAngularVel(body)) - LinkAngularVelocity(joint.parent_link);
    double q2 = 0;
    JointAngles(joint, R_WP.transpose() * R_WL, &state->q[joint.first], &q2);
    state->qdot[joint.first] = w_W.dot(R_WP * (joint.R_PJ * joint.axis1_J));
    if (joint.second < 0) continue;
    state->q[joint.second] = q2;
    state->qdot[joint.second] = w_W.dot(R_WL * joint.axis2_L);
  }
  state->p_WO = ToVector(dBodyGetPosition(object_body_));
  const dReal* q = dBodyGetQuaternion(object_body_);
  state->q_WO = Quaterniond(q[0], q[1], q[2], q[3]);
  state->v_WO = ToVector(dBodyGetLinearVel(object_body_));
  state->w_WO = ToVector(dBodyGetAngularVel(object_body_));
}

double OdeWorld::JointDrift() const {
  double largest = 0;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    dVector3 p1, p2;
    if (articulation_.joints[i].second < 0) {
      dJointGetHingeAnchor(joints_[i], p1);
      dJointGetHingeAnchor2(joints_[i], p2);
    } else {
      dJointGetUniversalAnchor(joints_[i], p1);
      dJointGetUniversalAnchor2(joints_[i], p2);
    }
    largest = std::max(largest, (ToVector(p1) - ToVector(p2)).norm());
  }
  return largest;
}

BodyMemory OdeWorld::Memory() const {
  BodyMemory memory;
  for (dBodyID body : bodies_) memory.bodies.push_back(ReadBody(body));
  memory.bodies.push_back(ReadBody(object_body_));
  memory.held = held_;
  memory.held_at = held_at_;
  return memory;
}

bool OdeWorld::Remember(const BodyMemory& memory) {
  if (memory.bodies.size() != bodies_.size() + 1) return false;
  dJointGroupEmpty(contact_group_);
  WriteBody(object_body_, memory.held_at);
  Hold(memory.held);
  held_at_ = memory.held_at;
  for (std::size_t b = 0; b < bodies_.size(); ++b) WriteBody(bodies_[b], memory.bodies[b]);
  WriteBody(object_body_, memory.bodies.back());
  return true;
}

}  // namespace regrasp
