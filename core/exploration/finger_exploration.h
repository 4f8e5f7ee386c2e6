#pragma once

/// One finger explores while the others hold: load transfer, Algorithm 1, and back into the grasp.

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"
#include "core/exploration/best_contact.h"
#include "core/exploration/objective.h"
#include "core/exploration/surface_exploration.h"

namespace regrasp {

class FingerExploration {
 public:
  enum class Phase : std::uint8_t {
    kIdle,
    kUnload,  ///< its force ramps down to the exploring force, the others take over
    kSettle,  ///< the finger presses with the exploring force and waits for the filters
    kSlide,   ///< Algorithm 1
    kReturn,  ///< back to the best point it met, if the last one is worse (not with the printed
              ///< rule)
    kReload,  ///< its force ramps up again
    kDone,
  };
  enum class End : std::uint8_t {
    kNone,
    kGradient,
    kMaxCycles,
    kContactLost,
    kObjectMoved,  ///< the others could not carry what the finger dragged
  };

  struct Request {
    int finger = -1;
    Criterion criterion = Criterion::kManipulability;
    Estimator estimator = Estimator::kLeastSquares;
    std::uint64_t seed = 0;
    int max_cycles = 0;  ///< 0 takes the parameter's
  };

  void Start(const Request& request);
  /// Ends sliding at the next tick and goes on to kReload.
  void Stop();
  /// One tick; changes the task of `request.finger` only. Where the load margin without this finger
  /// is small it presses less than exploration.normal_force.
  void Update(const ControlTick& tick, HybridController* controller, FingerTasks* tasks);

  const Request& request() const { return request_; }
  Phase phase() const { return phase_; }
  /// True in the tick in which sliding begins, and in which it ends (after kReturn): the moments at
  /// which phi is judged.
  bool slide_began() const { return slide_began_; }
  bool slide_ended() const { return slide_ended_; }
  End end() const { return end_; }
  double phi() const { return phi_; }
  double phi_initial() const { return phi_initial_; }
  double phi_final() const { return phi_final_; }
  bool on_stability() const { return on_stability_; }
  const SurfaceExploration& algorithm() const { return algorithm_; }
  /// i of Algorithm 1, over all tries.
  int cycles() const { return cycles_before_ + algorithm_.cycle(); }
  void AddTo(StateHasher* hasher) const;

 private:
  void EnterPhase(Phase phase);
  /// Whether another try is due: little was gained and at least half of N_max is left.
  bool TryAgain(const ExplorationParameters& parameters) const;
  void EndSlide(const Estimate& estimate, HybridController* controller);

  Request request_;
  Phase phase_ = Phase::kIdle;
  int ticks_ = 0;                      // in this phase
  int waited_ = 0;                     // ticks in a row with the object too far off its place
  int tries_ = 0, cycles_before_ = 0;  // of Algorithm 1; cycles of the tries before this one
  bool stop_ = false, slide_began_ = false, slide_ended_ = false;
  bool on_stability_ = false;
  End end_ = End::kNone;
  double slide_force_ = 0.4;  // normal force of this exploration [N]
  double phi_ = 0, phi_initial_ = 0, phi_final_ = 0;
  BestContact best_;
  SurfaceExploration algorithm_;
};

}  // namespace regrasp
