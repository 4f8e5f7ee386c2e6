#pragma once

/// One finger slides over the surface while the others hold, guided by Algorithm 1: load transfer,
/// a moment for the filters, the algorithm, back to the best contact it met, and load transfer
/// again. An exploration is one such slide on its own (finger_exploration.h); a regrasp of the gait
/// is one whose finger may go elsewhere first (core/gait/regrasp.h).
///
///   unload -> [away] -> settle -> [recall] -> explore <-> return -> reload -> done
///
/// Contact counts as lost after exploration.lost_contact_s without a reading of it.

#include <limits>
#include <optional>

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"
#include "core/exploration/best_contact.h"
#include "core/exploration/objective.h"
#include "core/exploration/surface_exploration.h"

namespace regrasp {

/// Constants that differ between a slide on its own and one within a gait.
struct SlideProfile {
  double transfer_s = 0.25;  ///< each load transfer [s]
  double leave_force = 0;    ///< Request::leaves: normal force when the finger goes away [N]
  double grip_force = 1;     ///< preferred normal force of the finger while it holds [N]
  double settle_s = 0.15;    ///< between load transfer and Algorithm 1 [s]
  double explore_s = std::numeric_limits<double>::infinity();  ///< longest run of Algorithm 1 [s]
  double return_limit_s = 2.5;  ///< longest recall, and longest return [s]
  int tries = 1;                ///< of Algorithm 1, while little is gained and N_max allows it
};

/// Where the slide may lead, in W; may move from tick to tick.
struct SlideGuide {
  Vector3d disc_centre_W = Vector3d::Zero();  ///< [m]
  /// The contact stays within this distance of the centre [m].
  double disc_radius = std::numeric_limits<double>::infinity();
  /// Slides here before Algorithm 1 begins [m].
  std::optional<Vector3d> recall_W;
};

/// Velocity of a contact towards where `error` (tangential, [m]) points: `gain` [1/s] times the
/// distance, at most `speed` [m/s].
inline Vector3d SlideTowards(const Vector3d& error, double gain, double speed) {
  return LimitNorm(gain * error, speed);
}

class GuidedSlide {
 public:
  enum class Phase : std::uint8_t {
    kIdle,
    kUnload,   ///< its force ramps down, the others take over
    kAway,     ///< Request::leaves: whoever started the slide moves the finger, until Land()
    kSettle,   ///< presses with the exploring force until the filters follow
    kRecall,   ///< slides to SlideGuide::recall_W
    kExplore,  ///< Algorithm 1
    kReturn,   ///< back to the best contact it met, if the last one is worse (without
               ///< InfoOf(estimator).keeps_best only from outside the disc)
    kReload,   ///< its force ramps up
    kDone,
  };
  /// Why the algorithm ended; kNone: not yet, or by Stop().
  enum class End : std::uint8_t {
    kNone,
    kGradient,
    kMaxCycles,
    kNoGain,  ///< for exploration.no_gain_s; where InfoOf(estimator).keeps_best
    kTime,    ///< SlideProfile::explore_s
    kContactLost,
    kObjectMoved,  ///< the others could not carry what the finger dragged
  };
  struct Request {
    int finger = -1;
    Criterion criterion = Criterion::kManipulability;
    Estimator estimator = kDefaultEstimator;
    std::uint64_t seed = 0;
    int max_cycles = 0;  ///< N_max; 0 takes the parameter's
    int without = -1;    ///< the stability that counts is that without this finger; -1: with all
    Vector3d turn_axis_W = Vector3d::Zero();  ///< of the coming turn, for the motion reserve
    Vector3d gradient_W = Vector3d::Zero();   ///< start of Algorithm 1 [1/m]; zero: random
    bool leaves = false;                      ///< goes away after unloading
    template <typename V>
    void Fields(V& v) {
      v("finger", finger, v.Finger());
      v("criterion", criterion, kLastCriterion);
      v("estimator", estimator, kLastEstimator);
      v("seed", seed);
      v("max_cycles", max_cycles);
      v("without", without, v.Finger());
      v("turn_axis_W", turn_axis_W);
      v("gradient_W", gradient_W);
      v("leaves", leaves);
    }
  };

  void Start(const Request& request);
  /// Back into the grasp at the next tick, through kReload. While the finger is away it stays with
  /// whoever moves it, who calls Land().
  void Stop() { stop_ = true; }
  /// The finger that was away touches again: explores from here, or reloads at once.
  void Land(bool explore);
  /// One tick; changes the task of `request.finger` only, none while it is away. Where the load
  /// margin without the finger is small it presses less than exploration.normal_force.
  void Update(const ControlTick& tick, const SlideProfile& profile, const SlideGuide& guide,
              HybridController* controller, FingerTasks* tasks);

  const Request& request() const { return request_; }
  Phase phase() const { return phase_; }
  bool active() const { return phase_ != Phase::kIdle && phase_ != Phase::kDone; }
  bool stopped() const { return stop_; }
  /// True in the tick in which sliding begins, and in which it ends (after kReturn): the moments at
  /// which phi is judged.
  bool slide_began() const { return slide_began_; }
  bool slide_ended() const { return slide_ended_; }
  End end() const { return end_; }
  /// Reloaded for exploration.reload_limit_s without touching: no surface to stand on.
  bool no_surface() const { return no_surface_; }
  double phi() const { return phi_; }
  /// Whether phi has been sensed since the finger began to press with its exploring force.
  bool phi_known() const {
    return slid_ || (phase_ == Phase::kSettle && ticks_ > 0) ||
           (phase_ > Phase::kSettle && phase_ < Phase::kReload);
  }
  double phi_initial() const { return phi_initial_; }  ///< where sliding began
  double phi_final() const { return phi_final_; }      ///< where it ended
  bool on_stability() const { return on_stability_; }
  const SurfaceExploration& algorithm() const { return algorithm_; }
  /// i of Algorithm 1, over all tries.
  int cycles() const { return cycles_before_ + algorithm_.cycle(); }
  template <typename V>
  void Fields(V& v) {
    v("request", request_);
    v("phase", phase_, Phase::kDone);
    v("ticks", ticks_);
    v("waited", waited_);
    v("tries", tries_);
    v("cycles_before", cycles_before_);
    v("stop", stop_);
    v("slid", slid_);
    v("was_on_tip", was_on_tip_);
    v("stays_on_side", stays_on_side_);
    v("no_surface", no_surface_);
    v("slide_began", slide_began_);
    v("slide_ended", slide_ended_);
    v("on_stability", on_stability_);
    v("end", end_, End::kObjectMoved);
    v("slide_force", slide_force_);
    v("cap_start", cap_start_);
    v("patience", patience_);
    v("excess", excess_, kUnbounded);
    v("phi", phi_);
    v("phi_initial", phi_initial_);
    v("phi_final", phi_final_);
    v("best", best_);
    v("algorithm", algorithm_);
  }

 private:
  void Enter(Phase phase);
  void Unload(const ControlTick& tick, const SlideProfile& profile, FingerTask* task);
  void Reload(const ControlTick& tick, const SlideProfile& profile, FingerTask* task);
  /// Settle, recall, explore and return: the finger touches with its exploring force.
  void Slide(const ControlTick& tick, const SlideProfile& profile, const SlideGuide& guide,
             HybridController* controller, FingerTask* task);
  /// Objective and walls as they are now; the disc counts as a wall.
  SurfaceExploration::Input Sense(const ControlTick& tick, const SlideGuide& guide);
  /// Ends the slide where it cannot go on; true when it did.
  bool MustEnd(const ControlTick& tick, const ObjectWrench& wrench);
  void Explore(const ControlTick& tick, const SlideProfile& profile,
               const SurfaceExploration::Input& input, FingerTask* task);
  /// Towards `to`; true when it is there, or has tried for long enough.
  bool Approach(const ControlTick& tick, const SlideProfile& profile, const Vector3d& to,
                const SurfaceExploration::Input& input, FingerTask* task);
  /// What is known of the best contact after this tick.
  void Remember(const ControlTick& tick, const SurfaceExploration::Input& input);
  void StartAlgorithm(const SurfaceExploration::Input& input,
                      const ExplorationParameters& parameters);
  /// Whether another try is due: little was gained and at least half of N_max is left.
  bool TryAgain(const SlideProfile& profile, const ExplorationParameters& parameters) const;
  void EndSlide(End end);

  Request request_;
  Phase phase_ = Phase::kIdle;
  int ticks_ = 0;                      // in this phase
  int waited_ = 0;                     // ticks in a row with the object too far off its place
  int tries_ = 0, cycles_before_ = 0;  // of Algorithm 1; cycles of the tries before this one
  bool stop_ = false, slid_ = false, no_surface_ = false;
  bool was_on_tip_ = false;     // while it slid, or explores on its side: has a best contact
  bool stays_on_side_ = false;  // of its link: it tried to slide onto its round tip and could not
  bool slide_began_ = false, slide_ended_ = false, on_stability_ = false;
  End end_ = End::kNone;
  double slide_force_ = 0;  // normal force of this slide [N]
  double cap_start_ = 0;    // where the ramp of a load transfer begins [N]
  double patience_ = 1;     // 1: the object is in its place, 0: the finger waits for it
  double excess_ = 0;       // beyond the disc, negative inside [m]
  double phi_ = 0, phi_initial_ = 0, phi_final_ = 0;
  BestContact best_;
  SurfaceExploration algorithm_;
};

}  // namespace regrasp
