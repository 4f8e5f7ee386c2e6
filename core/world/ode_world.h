#pragma once

/// What ODE holds of the world: bodies, joints, shapes. It finds the contacts for both steppers and
/// advances the exact one. Used only inside core/world. After an exception from ODE call Abandon().

#include <ode/ode.h>

#include <array>
#include <memory>
#include <vector>

#include "core/hand/kinematics.h"
#include "core/world/collision.h"
#include "core/world/world.h"

namespace regrasp {

class OdeWorld {
 public:
  OdeWorld(const HandModel& hand, const Articulation& articulation, const ObjectModel& object,
           const WorldConfig& config, const JointVector& q0, const Isometry3d& X_WO0);
  ~OdeWorld();
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;
  /// The ODE world is out of order and must not be touched any more.
  void Abandon();

  void Collide(FixedVector<ObjectHit, kMaxObjectContacts>* object_hits,
               FixedVector<LinkHit, kMaxLinkHits>* link_hits);

  /// Puts the bodies where a stepper of our own has moved them.
  void SetPoses(const KinematicsData& links, const WorldState& object);

  /// What acts during one step of dWorldStep, besides the contacts.
  struct Load {
    const JointVector& torque;   ///< drives, damping and stops [N m]
    const JointVector& damping;  ///< and so much more, at the rates after the step [N m s/rad]
    Vector3d push_W;             ///< on the object [N]
    Vector3d gravity_W;          ///< [m/s²]
    double friction;
    double mass;  ///< of the object [kg]
    bool held;    ///< the stand-in holds the object where it is
  };
  /// Advances by dt with dWorldStep; fills `state` and the forces of its contacts, which must be
  /// those of `hits`.
  void Step(const Load& load, const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
            const FixedVector<LinkHit, kMaxLinkHits>& link_hits, WorldState* state);

  /// Largest distance between the anchors of a joint on its two bodies [m].
  double JointDrift() const;
  BodyMemory Memory() const;
  /// Goes on from there; false, and nothing changes, where it is of another hand.
  bool Remember(const BodyMemory& memory);

 private:
  void BuildHand(const JointVector& q0);
  void BuildObject(const Isometry3d& X_WO0);
  Matrix3d LinkRotation(int link) const;
  Vector3d LinkAngularVelocity(int link) const;
  void Hold(bool on);
  void ApplyLoad(const Load& load);
  void SetDamping(const JointVector& damping);
  void MakeContacts(const FixedVector<ObjectHit, kMaxObjectContacts>& hits,
                    const FixedVector<LinkHit, kMaxLinkHits>& link_hits, double friction);
  void Read(WorldState* state) const;

  const HandModel& hand_;
  const Articulation& articulation_;
  const ObjectModel& object_;
  WorldConfig config_;
  dWorldID world_ = nullptr;
  dJointGroupID contact_group_ = nullptr;
  dThreadingImplementationID threading_ = nullptr;
  std::vector<dBodyID> bodies_;
  std::vector<dJointID> joints_;  // joints_[i] is articulation.joints[i]
  dBodyID object_body_ = nullptr;
  dJointID stand_in_joint_ = nullptr;
  bool held_ = false;
  BodyMemory::Body held_at_;  // where the stand-in took the object
  double mass_ = 0;
  std::array<dJointFeedback, kMaxObjectContacts> feedback_{};
  std::unique_ptr<Collider> collider_;
};

}  // namespace regrasp
