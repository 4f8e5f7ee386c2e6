#pragma once

/// Coupled joints in the simulation. Both steppers get the plant, the hand with every joint on its
/// own, parents before children. In the fast step a coupled joint moves exactly with its driver
/// (Following). The exact step knows independent joints only: there an elastic transmission, a
/// spring and damper like those of the joint stops, holds it at ratio q(driver) + offset.

#include <vector>

#include "core/common/limits.h"
#include "core/hand/hand_model.h"
#include "core/world/hand_dynamics.h"

namespace regrasp {

class Transmissions {
 public:
  /// `stiffness` [N m/rad] and `damping` [N m s/rad] of each; less where the inertias are too small
  /// for the step `dt` [s]. A spring K and a damper D are stable in a semi-implicit Euler step
  /// where dt² K + 2 dt D < 4 I, I the inertia that resists the torque of the transmission; all
  /// that follow one driver together take at most 0.8 I / dt² and 0.5 I / dt.
  Transmissions(const HandModel& hand, double stiffness, double damping, double dt);

  /// The same hand without couplings: joint i moves link i + 1. Fingers name no joints.
  const HandModel& plant() const { return plant_; }
  bool any() const { return !springs_.empty(); }
  /// By joint of the plant; empty where no joint is coupled.
  const std::vector<Following>& following() const { return following_; }
  int count() const { return static_cast<int>(springs_.size()); }

  /// Values of the driven joints as those of the plant: 0 for coupled joints.
  JointVector ToPlant(const JointVector& driven) const;
  /// The same for angles [rad]: coupled joints where their drivers put them.
  JointVector AnglesToPlant(const JointVector& driven) const;
  JointVector FromPlant(const JointVector& plant) const;

  /// Adds what the transmissions exert to `torque` [N m]; all of the plant.
  void AddTorques(const JointVector& q, const JointVector& qdot, JointVector* torque) const;

 private:
  struct Spring {
    int joint = -1, driver = -1;  // of the plant
    double ratio = 1, offset = 0, stiffness = 0, damping = 0;
  };
  HandModel plant_;
  std::vector<int> place_;  // joint of the hand: joint of the plant
  int num_driven_ = 0;
  std::vector<Spring> springs_;
  std::vector<Following> following_;
};

}  // namespace regrasp
