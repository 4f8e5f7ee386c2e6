#pragma once

/// Keeps every quality measure of the present grasp fresh without ever standing in the way of a
/// tick: one load margin every kMarginInterval in turn, epsilon a few facets at a time in the ticks
/// between, the others when somebody looks. What is done in which tick depends on nothing but the
/// number of ticks and the grasp.

#include <array>

#include "core/control/control_tick.h"
#include "core/quality/epsilon.h"
#include "core/session/frame.h"

namespace regrasp {

class QualityMonitor {
 public:
  static constexpr double kMarginInterval = 0.005;     ///< from one load margin to the next [s]
  static constexpr double kEpsilonInterval = 0.050;    ///< from one beginning on, at least [s]
  static constexpr int kEpsilonFacets = 30;            ///< facets per tick (about 0.2 us each)
  static constexpr int kEpsilonEdges = kMonitorEdges;  ///< of the friction pyramid
  static constexpr int kMaxEpsilonSteps = 10000;       ///< more are never needed

  void Update(const ControlTick& now);
  /// Of the present grasp; epsilon of that some 0.1 s ago, NaN until it has been computed once.
  StabilityFrame stability(const ControlTick& now) const;
  /// Load margins for the controllers: low-passed.
  const LoadMargins& margins() const { return margins_; }
  /// rho of the grasp without this finger, as last computed [N].
  double load_margin_without(int finger) const { return load_margin_without_[finger]; }
  template <typename V>
  void Fields(V& v) {
    v("load_margin", load_margin_, kUnbounded);
    v("load_margin_without", load_margin_without_, kUnbounded);
    v("margins", margins_);
    v("tick", tick_, FieldRange{0, 1e6});
    v("turn", turn_, FieldRange{0, kMaxFingers});
    v("epsilon_grasp", epsilon_grasp_);
    v("epsilon_scale", epsilon_scale_, FieldRange{1e-6, 1e3});
    v("epsilon_begun", epsilon_begun_);
    v("epsilon_steps", epsilon_steps_, FieldRange{0, kMaxEpsilonSteps});
    v("epsilon_ticks", epsilon_ticks_);
    v("epsilon_known", epsilon_known_);
    v("epsilon_result", epsilon_result_);
    if constexpr (V::kLoads) RepeatEpsilon();
  }

 private:
  void UpdateMargin(const ControlTick& now);
  void SmoothMargins(double gain);
  void UpdateEpsilon(const ControlTick& now);
  void BeginEpsilon();
  /// Brings the solver to where a loaded state had it.
  void RepeatEpsilon();

  double load_margin_ = 0;  // of the whole grasp [N]
  std::array<double, kMaxFingers> load_margin_without_{};
  LoadMargins margins_;
  int tick_ = 0;  // since the last load margin
  int turn_ = 0;  // whose load margin comes next; the number of fingers: the whole grasp's
  // The solver's state is what it began with and how far it has come.
  EpsilonSolver epsilon_;
  Grasp epsilon_grasp_;
  double epsilon_scale_ = 0.02;
  bool epsilon_begun_ = false;
  int epsilon_steps_ = 0;
  int epsilon_ticks_ = 0;  // since the last beginning
  bool epsilon_known_ = false;
  double epsilon_result_ = 0;
};

}  // namespace regrasp
