#pragma once

/// The hybrid position/force controller: turns one task per finger and the wanted object wrench
/// into joint torques.
///
///   holding fingers    contact forces f from the friction-cone QP, tau = Jᵀ f
///   sliding finger     force along its normal, motion in its tangent plane (Sec. II: "the command
///   to
///                      the hybrid controller")
///   reaching finger    fingertip position control without contact
///   posture            joint position control
///
/// To each: gravity compensation, a posture spring and a spring away from joint limits, both in the
/// null space of the contact force, and d * qdot_ref against the joints' own damping d, with
/// qdot_ref = J⁺ v of the wanted contact velocity v.

#include <array>

#include "core/control/contact_force_qp.h"
#include "core/control/control_parameters.h"
#include "core/control/estimate.h"
#include "core/control/object_wrench.h"

namespace regrasp {

enum class FingerMode : std::uint8_t {
  kPosture,  ///< joints to `q_target`
  kTouch,    ///< press with `force` along the inward normal, no part in the QP
  kHold,     ///< force from the QP, normal force at most `cap`
  kSlide,    ///< normal force `force`, tangential velocity `v_W`
  kReach,    ///< fingertip centre to `p_target_W`
};

struct FingerTask {
  FingerMode mode = FingerMode::kPosture;
  FingerVector q_target;                   ///< kPosture [rad]; its finger's joints, root to tip
  double force = 0.15;                     ///< kTouch, kSlide [N]
  double cap = 4.0;                        ///< kHold [N]
  double grip = 1.0;                       ///< kHold: preferred normal force [N]
  Vector3d v_W = Vector3d::Zero();         ///< kSlide: of the contact over the surface [m/s]
  Vector3d p_target_W = Vector3d::Zero();  ///< kReach [m]
  Vector3d v_target_W = Vector3d::Zero();  ///< kReach: velocity of the target [m/s]
  template <typename V>
  void Fields(V& v) {
    v("mode", mode, FingerMode::kReach);
    v("q_target", q_target);
    v("force", force);
    v("cap", cap);
    v("grip", grip);
    v("v_W", v_W);
    v("p_target_W", p_target_W);
    v("v_target_W", v_target_W);
  }
};

/// One task per finger.
using FingerTasks = FixedVector<FingerTask, kMaxFingers>;

/// Wanted motion of the object in this tick.
struct ObjectMotion {
  Vector3d v_W = Vector3d::Zero();  ///< [m/s]
  Vector3d w_W = Vector3d::Zero();  ///< [rad/s]
  template <typename V>
  void Fields(V& v) {
    v("v_W", v_W);
    v("w_W", w_W);
  }
};

class HybridController {
 public:
  HybridController(const HandModel& hand, double dt);

  /// Starts holding the object where it is estimated to be; the posture springs rest where the
  /// joints are.
  void StartHolding(const Estimate& estimate, const Vector3d& gravity_W,
                    const ControlParameters& parameters);
  /// The joints' resting posture becomes the present one for this finger.
  void RestHere(const Estimate& estimate, int finger);

  /// Joint torques [N m, model order] of this tick. Moves the object reference by `motion`.
  const JointVector& Update(const Estimate& estimate, const FingerTasks& tasks,
                            const ObjectMotion& motion, const Vector3d& gravity_W,
                            const ControlParameters& parameters);

  ObjectWrench& wrench() { return wrench_; }
  const ObjectWrench& wrench() const { return wrench_; }
  /// Force on the object that each finger was asked for in the last tick [N].
  const FixedVector<Vector3d, kMaxFingers>& commanded_forces() const { return commanded_; }
  double qp_residual() const { return qp_.residual(); }
  template <typename V>
  void Fields(V& v) {
    v("wrench", wrench_);
    v("qp", qp_);
    v("states", states_);
    v("q_rest", q_rest_);
    v("commanded", commanded_);
    if constexpr (V::kLoads)
      if (q_rest_.size() != hand_->num_joints() || commanded_.size() != hand_->fingers.size())
        v.Refuse("q_rest", "is of another hand");
  }

 private:
  struct FingerState {
    FingerMode mode = FingerMode::kPosture;
    Vector3d p_ref_W = Vector3d::Zero();  // kSlide: reference of the fingertip centre
    double normal_integral = 0;           // kSlide [N]
    template <typename V>
    void Fields(V& v) {
      v("mode", mode, FingerMode::kReach);
      v("p_ref_W", p_ref_W);
      v("normal_integral", normal_integral);
    }
  };
  /// Tip force on the object for a sliding finger; updates its reference.
  Vector3d SlideForce(const FingerEstimate& finger, const FingerTask& task,
                      const Vector3d& v_surface, const ControlParameters& parameters,
                      FingerState* state);

  const HandModel* hand_;
  double dt_;
  ObjectWrench wrench_;
  ContactForceQp qp_;
  ForceProblem problem_;
  std::array<FingerState, kMaxFingers> states_{};
  JointVector q_rest_;
  JointVector torque_;
  FixedVector<Vector3d, kMaxFingers> commanded_;
};

}  // namespace regrasp
