#pragma once

/// Looks for contacts near the present ones from which the opposing finger may leave. The paper's
/// state S_F has the same end: there "the grasp stability is chosen as the objective function", the
/// thumb being "excluded from the holding task".

#include "core/common/random.h"
#include "core/gait/stance.h"

namespace regrasp {

/// Random local search for the largest load margin of a stance without one finger. One evaluation
/// per call of Step(): a load margin costs some 50 us, so that it is called every few ticks.
class StanceSearch {
 public:
  /// `stance`: contacts of all fingers, from which the search sets out; `fingers`: those
  /// that touch; `without`: finger that shall leave; the others may be at most `max_shift` [m] from
  /// where `first` has them.
  void Start(const Stance& first, const Stance& stance, FingerSet fingers, int without,
             double max_shift, std::uint64_t seed);
  /// One evaluation. weight [N]; torque_scale [m]; max_force [N].
  void Step(const Vector3d& weight, double mu, double torque_scale, double max_force,
            double step_size);
  const Stance& stance() const { return best_; }
  double margin() const { return margin_; }  ///< of stance(); < 0 before the first step [N]
  int evaluations() const { return evaluations_; }
  template <typename V>
  void Fields(V& v) {
    v("first", first_);
    v("best", best_);
    v("fingers", fingers_);
    v("without", without_, v.Finger());
    v("max_shift", max_shift_);
    v("margin", margin_, kUnbounded);
    v("evaluations", evaluations_);
    v("random", random_);
  }

 private:
  Stance first_, best_;
  FingerSet fingers_;
  int without_ = -1;
  double max_shift_ = 0, margin_ = -1;
  int evaluations_ = 0;
  RandomStream random_;
};

}  // namespace regrasp
