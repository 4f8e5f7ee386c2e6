#pragma once

/// The whole stance, planned on the felt surface: where all the other fingers shall stand so that
/// one of them may leave. Random local search from where they stand, one trial a tick; a trial
/// moves some contacts over the felt surface to where their fingers reach.

#include "core/common/random.h"
#include "core/gait/landing_plan.h"

namespace regrasp {

class StancePlan {
 public:
  /// `leaves`: the finger that shall leave; the others go at most `reach` [m].
  void Start(const ControlTick& tick, int leaves, double reach, std::uint64_t seed);
  /// One trial: some 80 us. True once the margin wanted is met or nothing more is tried.
  bool Step(const ControlTick& tick);
  int leaves() const { return leaves_; }
  double margin() const { return margin_; }              ///< rho without `leaves` of the plan [N]
  double first_margin() const { return first_margin_; }  ///< of where the fingers stand [N]
  const Landing& landing(int finger) const { return best_[finger]; }
  template <typename V>
  void Fields(V& v) {
    v("leaves", leaves_, v.Finger());
    v("reach", reach_);
    v("margin", margin_);
    v("first_margin", first_margin_);
    v("trials", trials_);
    v("first", first_);
    v("best", best_);
    v("random", random_);
  }

 private:
  using Landings = std::array<Landing, kMaxFingers>;
  double MarginOf(const ControlTick& tick, const Landings& landings) const;
  bool Move(const ControlTick& tick, int finger, Landings* trial);

  int leaves_ = -1;
  double reach_ = 0, margin_ = 0, first_margin_ = 0;
  int trials_ = 0;
  Landings first_{}, best_{};
  RandomStream random_;
};

}  // namespace regrasp
