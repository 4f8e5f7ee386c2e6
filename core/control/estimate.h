#pragma once

/// The controller's picture of the world: filtered sensor readings and what kinematics makes of
/// them. What comes seldom or in cells is followed in between: the object's pose by the fingers
/// that hold it (finger_motion.h), a contact within the cell of a taxel (taxel_contact.h).

#include <array>

#include "core/common/fields.h"
#include "core/common/finger_set.h"
#include "core/control/control_parameters.h"
#include "core/control/finger_motion.h"
#include "core/control/taxel_contact.h"
#include "core/hand/kinematics.h"
#include "core/quality/grasp.h"
#include "core/sensing/sensor_reading.h"

namespace regrasp {

/// How long without contact is too long depends on what for: control.contact_lost_s (`lost`: it is
/// left out of grasps and margins), control.reapproach_delay_s (it moves in again), gait.away_s
/// (the gait does not count on it), exploration.lost_contact_s (a slide ends).
struct FingerEstimate {
  bool in_contact = false;       ///< this tick's reading
  bool ever_in_contact = false;  ///< p_WC and normal_W hold something
  bool lost = false;             ///< without contact for control.contact_lost_s: carries nothing
  int ticks_without_contact = 0;
  int ticks_in_contact = 0;
  Vector3d p_WC =
      Vector3d::Zero();  ///< filtered contact point; the last one while out of contact [m]
  Vector3d normal_W = Vector3d::UnitZ();  ///< filtered outward object normal
  double force = 0;                       ///< filtered normal force [N]
  FingerJacobian J;                  ///< at p_WC, or at the fingertip centre if never in contact
  Vector3d p_WF = Vector3d::Zero();  ///< fingertip centre [m]
  double manipulability = 0;         ///< at p_WC [kManipulabilityUnit: 1e-4 m³]

  /// What is not a function of the others and of the joint angles.
  template <typename V>
  void Fields(V& v) {
    v("in_contact", in_contact);
    v("ever_in_contact", ever_in_contact);
    v("lost", lost);
    v("ticks_without_contact", ticks_without_contact);
    v("ticks_in_contact", ticks_in_contact);
    v("p_WC", p_WC);
    v("normal_W", normal_W);
    v("force", force);
  }
};

struct Estimate {
  JointVector q;  ///< [rad]
  KinematicsData kinematics;
  FixedVector<FingerEstimate, kMaxFingers> fingers;
  Vector3d p_WO = Vector3d::Zero();  ///< [m]
  Quaterniond q_WO = Quaterniond::Identity();
  double object_scale = 0.02;  ///< mean distance of the contacts from p_WO: the torque scale [m]
};

/// First-order low passes over the sensor readings. Contact points are filtered in the frame of the
/// fingertip, where they move slowly while the finger moves.
class StateEstimator {
 public:
  StateEstimator(const HandModel& hand, double dt) : hand_(&hand), dt_(dt) {}
  /// Forgets everything.
  void Reset() { *this = StateEstimator(*hand_, dt_); }
  /// One tick. `holding`: the fingers that hold the object, without sliding. Where the pose comes
  /// seldom (SensorReading::object_rate_hz) they tell how it moves in between.
  const Estimate& Update(const SensorReading& reading, const ControlParameters& parameters,
                         FingerSet holding = {});
  const Estimate& estimate() const { return estimate_; }
  template <typename V>
  void Fields(V& v) {
    Estimate& e = estimate_;
    v("started", started_);
    v("contact", contact_);
    v("q", e.q);
    v("fingers", e.fingers);
    v("p_WO", e.p_WO);
    v("q_WO", e.q_WO);
    v("object_scale", e.object_scale);
    v("num_poses", num_poses_, FieldRange{0, kManyPoses});
    v("pose_tick", pose_tick_, kCountOrNone);
    v("velocity", velocity_W_);
    v("spin", spin_W_);
    if constexpr (V::kLoads) {
      if (!started_) return;
      if (e.q.size() != hand_->num_joints() || e.fingers.size() != hand_->fingers.size())
        v.Refuse("q", "is of another hand");
      Derive();
    }
  }

 private:
  struct ContactFilter {
    Vector3d p_L = Vector3d::Zero(), n_L = Vector3d::UnitZ();  // in the tip link's frame
    template <typename V>
    void Fields(V& v) {
      v("p_L", p_L);
      v("n_L", n_L);
    }
  };
  void UpdatePose(const SensorReading& reading, const ControlParameters& parameters,
                  const RigidStep& step);
  /// How the object moved while the joints moved by `dq`, by the fingers in `holding`.
  RigidStep StepOf(const JointVector& dq, FingerSet holding) const;
  /// The normal of contact `i` in the tip's frame, from a taxel (taxel_contact.h).
  Vector3d NormalFromTaxel(int i, const Vector3d& p_L, const SensorReading& reading, bool fresh,
                           const RigidStep& step, const Vector3d& p_WF_before);
  /// Everything that follows from the joint angles and the contact points.
  void Derive();
  const HandModel* hand_;
  double dt_;
  bool started_ = false;
  std::array<ContactFilter, kMaxFingers> contact_{};
  std::array<TaxelContact, kMaxFingers> taxels_;  // made when a reading says their pitch
  static constexpr int kManyPoses = 1000;         // of which the mean is as good as known
  int num_poses_ = 0;                             // so far
  std::int64_t pose_tick_ = -1;                   // SensorReading::object_tick of the last one
  Vector3d velocity_W_ = Vector3d::Zero(), spin_W_ = Vector3d::Zero();  // by the fingers
  Estimate estimate_;
};

/// The contacts of these fingers, positions relative to the estimated object centre, friction
/// coefficient `mu`. Fingers that have lost contact (control.contact_lost_s) are left out.
Grasp GraspOf(const Estimate& estimate, FingerSet fingers, double mu);

}  // namespace regrasp
