#pragma once

/// Looks for contacts near the present ones from which the opposing finger may leave: what the
/// paper's state S_F is for ("before the thumb leaves, the grasp without it is made stable").

#include "core/common/random.h"
#include "core/control/estimate.h"

namespace regrasp {

/// One contact of a stance, relative to the object's reference position, in W axes.
struct StanceContact {
  Vector3d p_OC = Vector3d::Zero();       ///< contact [m]
  Vector3d p_OF = Vector3d::Zero();       ///< fingertip centre [m]
  Vector3d normal_W = Vector3d::UnitZ();  ///< outward
};
using Stance = FixedVector<StanceContact, kMaxFingers>;

/// Moves a contact over the surface by `step` (tangential, [m]). Surface model: the sphere through
/// the contact with the contact's normal and its distance from the object's centre as radius.
StanceContact Shifted(const StanceContact& contact, const Vector3d& step);

/// Random local search for the largest load margin of a stance without one finger. One evaluation
/// per call of Step(): a load margin costs some 50 us, so that it is called every few ticks.
class StanceSearch {
 public:
  /// `stance`: contacts of all fingers, from which the search sets out; `fingers`: bits of those
  /// that touch; `without`: finger that shall leave; the others may be at most `max_shift` [m] from
  /// where `first` has them.
  void Start(const Stance& first, const Stance& stance, unsigned fingers, int without,
             double max_shift, std::uint64_t seed);
  /// One evaluation. weight [N]; torque_scale [m]; max_force [N].
  void Step(const Vector3d& weight, double mu, double torque_scale, double max_force);
  const Stance& stance() const { return best_; }
  double margin() const { return margin_; }  ///< of stance(); < 0 before the first step [N]
  int evaluations() const { return evaluations_; }
  void AddTo(StateHasher* hasher) const;

 private:
  Stance first_, best_;
  unsigned fingers_ = 0;
  int without_ = -1;
  double max_shift_ = 0, margin_ = -1;
  int evaluations_ = 0;
  RandomStream random_;
};

}  // namespace regrasp
