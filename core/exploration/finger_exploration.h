#pragma once

/// One finger explores while the others hold: a guided slide on its own, with tries again where
/// little was gained.

#include "core/exploration/guided_slide.h"

namespace regrasp {

class FingerExploration {
 public:
  using Phase = GuidedSlide::Phase;
  using End = GuidedSlide::End;

  struct Request {
    int finger = -1;
    Criterion criterion = Criterion::kManipulability;
    Estimator estimator = kDefaultEstimator;
    std::uint64_t seed = 0;
    int max_cycles = 0;                       ///< 0 takes the parameter's
    Vector3d turn_axis_W = Vector3d::Zero();  ///< of the coming turn, for the motion reserve
    template <typename V>
    void Fields(V& v) {
      v("finger", finger, v.Finger());
      v("criterion", criterion, kLastCriterion);
      v("estimator", estimator, kLastEstimator);
      v("seed", seed);
      v("max_cycles", max_cycles);
      v("turn_axis_W", turn_axis_W);
    }
  };

  void Start(const Request& request);
  /// Ends sliding at the next tick and goes on to kReload.
  void Stop() { slide_.Stop(); }
  /// One tick; changes the task of `request.finger` only.
  void Update(const ControlTick& tick, HybridController* controller, FingerTasks* tasks);

  const Request& request() const { return request_; }
  Phase phase() const { return slide_.phase(); }
  bool slide_began() const { return slide_.slide_began(); }
  bool slide_ended() const { return slide_.slide_ended(); }
  End end() const { return slide_.end(); }
  double phi() const { return slide_.phi(); }
  double phi_initial() const { return slide_.phi_initial(); }
  double phi_final() const { return slide_.phi_final(); }
  bool on_stability() const { return slide_.on_stability(); }
  const SurfaceExploration& algorithm() const { return slide_.algorithm(); }
  /// i of Algorithm 1, over all tries.
  int cycles() const { return slide_.cycles(); }
  const GuidedSlide& slide() const { return slide_; }
  template <typename V>
  void Fields(V& v) {
    v("request", request_);
    v("slide", slide_);
  }

 private:
  Request request_;
  GuidedSlide slide_;
};

}  // namespace regrasp
