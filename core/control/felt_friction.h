#pragma once

/// How rough the object is, felt by fingers that slide over it: while one does, the force with
/// which it is moved along is its friction, mu = f_v / f_n, f_v the tip's force along the velocity.
/// The tip's force is what the joint torques leave after the weight and the joints' own damping:
/// Jᵀ f = tau - tau_gravity - d qdot. The mean over what has slid lately, less a share for what is
/// uncertain, is the coefficient that forces and load margins count on.

#include "core/control/hybrid_controller.h"

namespace regrasp {

class FeltFriction {
 public:
  /// One tick of `dt` [s]. `torque`: of the joints [N m, model order], under `gravity_W` [m/s²].
  void Update(const HandModel& hand, const Estimate& estimate, const FingerTasks& tasks,
              const JointVector& torque, const Vector3d& gravity_W,
              const ControlParameters& parameters, double dt);
  /// Fingers have slid for long enough, and what they felt can be: strong damping and a finger that
  /// something is in the way of make a mean of less than the least that is counted on, even less
  /// than 0, with which none could leave any more.
  bool known(const ControlParameters& parameters) const {
    return felt_s_ >= parameters.feel_enough_s && mean_ >= parameters.feel_least;
  }
  double felt() const { return mean_; }      ///< mean of f_v / f_n; 0: nothing has slid
  double felt_s() const { return felt_s_; }  ///< time over which it was felt [s]
  /// What to count on: `share` of what was felt, from feel_least to feel_most; friction_estimate
  /// until it is known. The more is counted on, the nearer to slipping the fingers hold, and what
  /// is felt by a few tips on a few spots may be too much.
  double Counted(double share, const ControlParameters& parameters) const;
  template <typename V>
  void Fields(V& v) {
    v("mean", mean_);
    v("felt_s", felt_s_);
    v("sliding_s", sliding_s_);
    v("q_before", q_before_);
  }

 private:
  double mean_ = 0, felt_s_ = 0;
  std::array<double, kMaxFingers> sliding_s_{};  // in a row, by finger
  JointVector q_before_;                         // in the tick before [rad]
};

}  // namespace regrasp
