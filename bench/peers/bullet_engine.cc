#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>

#include <stdexcept>

#include "bench/peers/engine.h"

namespace regrasp::bench {
namespace {

constexpr int kHand = 1, kObject = 2;  // collision groups: links do not touch each other

btVector3 ToBt(const Vector3d& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }
Vector3d FromBt(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btQuaternion ToBt(const Quaterniond& q) {
  return {btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())};
}
btTransform ToBt(const Isometry3d& X) {
  return btTransform(ToBt(Quaterniond(X.linear())), ToBt(Vector3d(X.translation())));
}

class Bullet : public Engine {
 public:
  Bullet(const LoadedScenario& model, const JointVector& q0, const Isometry3d& X_WO,
         const Vector3d& gravity_W)
      : dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_),
        hand_(model.hand.num_joints(), 0, btVector3(1, 1, 1), true, false),
        start_(ToBt(X_WO)),
        q_(q0) {
    world_.setGravity(ToBt(gravity_W));
    for (int i = 0; i < q0.size(); ++i) AddJoint(model.hand, i);
    hand_.finalizeMultiDof();
    hand_.setHasSelfCollision(false);
    hand_.setLinearDamping(0);
    hand_.setAngularDamping(0);
    for (int i = 0; i < q0.size(); ++i) hand_.setJointPos(i, q0[i]);
    world_.addMultiBody(&hand_);
    for (std::size_t link = 0; link < model.hand.links.size(); ++link)
      AddShapes(model, static_cast<int>(link));
    AddObject(model.object);
    Place();
  }
  ~Bullet() override {
    for (auto& collider : colliders_) world_.removeCollisionObject(collider.get());
    world_.removeRigidBody(object_.get());
    world_.removeMultiBody(&hand_);
  }

  void Step(const JointVector& torque, bool held) override {
    for (int i = 0; i < q_.size(); ++i)
      hand_.addJointTorque(
          i, torque[i] - damping_[static_cast<std::size_t>(i)] * hand_.getJointVel(i));
    if (held) {
      object_->setCenterOfMassTransform(start_);
      object_->setLinearVelocity({0, 0, 0});
      object_->setAngularVelocity({0, 0, 0});
    }
    world_.stepSimulation(1e-3, 0);
    for (int i = 0; i < q_.size(); ++i) q_[i] = hand_.getJointPos(i);
  }
  const JointVector& q() const override { return q_; }
  Vector3d p_WO() const override { return FromBt(object_->getCenterOfMassPosition()); }
  Quaterniond q_WO() const override {
    const btQuaternion q = object_->getOrientation();
    return {q.w(), q.x(), q.y(), q.z()};
  }
  std::vector<Touch> touches() const override {
    std::vector<Touch> found;
    for (int m = 0; m < world_.getDispatcher()->getNumManifolds(); ++m) {
      const btPersistentManifold* manifold =
          const_cast<btMultiBodyDynamicsWorld&>(world_).getDispatcher()->getManifoldByIndexInternal(
              m);
      const int finger =
          std::max(manifold->getBody0()->getUserIndex(), manifold->getBody1()->getUserIndex());
      for (int k = 0; k < manifold->getNumContacts() && finger >= 0; ++k) {
        const btManifoldPoint& point = manifold->getContactPoint(k);
        if (point.getDistance() > 0) continue;
        found.push_back(
            {finger, FromBt(point.getPositionWorldOnB()), point.getAppliedImpulse() / 1e-3});
      }
    }
    return found;
  }
  double joint_drift() const override { return 0; }  // joint coordinates

 private:
  void AddJoint(const HandModel& hand, int i) {
    const Joint& joint = hand.joints[i];
    const Link &parent = hand.links[joint.parent_link], &child = hand.links[joint.child_link];
    const Vector3d parent_com = parent.parent_joint >= 0 ? parent.p_LCom : Vector3d::Zero();
    const Vector3d inertia = child.I_LCom.diagonal() + joint.armature * joint.axis_J.cwiseAbs2();
    hand_.setupRevolute(i, child.mass, ToBt(inertia), parent.parent_joint,
                        ToBt(Quaterniond(joint.X_PJ.linear()).conjugate()), ToBt(joint.axis_J),
                        ToBt(Vector3d(joint.X_PJ.translation() - parent_com)), ToBt(child.p_LCom),
                        true);
    damping_.push_back(joint.damping);
  }
  void AddShapes(const LoadedScenario& model, int link) {
    const Link& l = model.hand.links[link];
    if (l.shapes.empty()) return;
    auto compound = std::make_unique<btCompoundShape>();
    const Vector3d com = l.parent_joint >= 0 ? l.p_LCom : Vector3d::Zero();
    for (const Shape& s : l.shapes) {
      btTransform X = btTransform::getIdentity();
      if (s.kind == Shape::Kind::kBox) {
        shapes_.push_back(std::make_unique<btBoxShape>(ToBt(s.half_extents)));
        X = ToBt(Isometry3d(Eigen::Translation3d(-com) * s.X_LB));
      } else {
        const Vector3d along = s.b_L - s.a_L;
        const double length = along.norm();
        Isometry3d X_LS = Isometry3d::Identity();
        X_LS.translation() = 0.5 * (s.a_L + s.b_L) - com;
        if (length > 1e-9) {
          X_LS.linear() = RotationFromZ(along / length);
          shapes_.push_back(std::make_unique<btCapsuleShapeZ>(s.radius, length));
        } else {
          shapes_.push_back(std::make_unique<btSphereShape>(s.radius));
        }
        X = ToBt(X_LS);
      }
      compound->addChildShape(X, shapes_.back().get());
    }
    auto collider = std::make_unique<btMultiBodyLinkCollider>(&hand_, l.parent_joint);
    collider->setCollisionShape(compound.get());
    collider->setFriction(1);
    int finger = -1;
    for (int f = 0; f < model.hand.num_fingers(); ++f)
      if (model.hand.fingers[f].tip_link == link) finger = f;
    collider->setUserIndex(finger);
    world_.addCollisionObject(collider.get(), kHand, kObject);
    if (l.parent_joint >= 0)
      hand_.getLink(l.parent_joint).m_collider = collider.get();
    else
      hand_.setBaseCollider(collider.get());
    shapes_.push_back(std::move(compound));
    colliders_.push_back(std::move(collider));
  }
  void AddObject(const ObjectModel& object) {
    if (object.kind == ObjectModel::Kind::kSphere)
      shapes_.push_back(std::make_unique<btSphereShape>(object.radius));
    else if (object.kind == ObjectModel::Kind::kBox)
      shapes_.push_back(std::make_unique<btBoxShape>(ToBt(object.half_extents)));
    else
      throw std::runtime_error("Bullet: only spheres and boxes");
    object_ = std::make_unique<btRigidBody>(object.mass, nullptr, shapes_.back().get(),
                                            ToBt(Vector3d(object.I_OCom.diagonal())));
    object_->setCenterOfMassTransform(start_);
    object_->setFriction(object.friction);  // of a pair: the product
    object_->setActivationState(DISABLE_DEACTIVATION);
    object_->setUserIndex(-1);
    world_.addRigidBody(object_.get(), kObject, kHand);
  }
  void Place() {
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> positions;
    hand_.forwardKinematics(rotations, positions);
    hand_.updateCollisionObjectWorldTransforms(rotations, positions);
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_;
  btMultiBody hand_;
  btTransform start_;
  JointVector q_;
  std::vector<double> damping_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::unique_ptr<btRigidBody> object_;
};

}  // namespace

std::unique_ptr<Engine> MakeBullet(const LoadedScenario& model, const JointVector& q0,
                                   const Isometry3d& X_WO, const Vector3d& gravity_W) {
  return std::make_unique<Bullet>(model, q0, X_WO, gravity_W);
}

}  // namespace regrasp::bench
