#pragma once

/// One finger gives up its contact and takes another one while the others hold: load transfer, the
/// way (a hop or a slide) to its target in the palm, Algorithm 1 there if wanted, and load transfer
/// back.

#include "core/control/control_tick.h"
#include "core/control/hybrid_controller.h"
#include "core/exploration/best_contact.h"
#include "core/exploration/objective.h"
#include "core/exploration/surface_exploration.h"
#include "core/gait/gait_parameters.h"

namespace regrasp {

class Regrasp {
 public:
  enum class Phase : std::uint8_t {
    kIdle,
    kUnload,   ///< its force ramps down, the others take over
    kLift,     ///< off the surface
    kAcross,   ///< above the surface, to above the target
    kDown,     ///< until it touches
    kSlide,    ///< over the surface to the target, or
    kSettle,   ///< explore: presses with the exploring force until the filters follow
    kRecall,   ///< explore: slides to where the finger's last explorations ended
    kExplore,  ///< Algorithm 1
    kReturn,   ///< back to the best contact it met, if the last one is worse
    kReload,   ///< its force ramps up
    kDone,
  };

  struct Request {
    int finger = -1;
    bool hop = true;  ///< otherwise it slides
    bool explore = false;
    Criterion criterion = Criterion::kManipulability;
    int without =
        -1;  ///< explore: the stability that counts is that without this finger; -1: with all
    std::uint64_t seed = 0;
    Vector3d gradient_W = Vector3d::Zero();  ///< start of Algorithm 1 [1/m]; zero: random
    double disc_share = 1;  ///< explore: of gait.disc_radius, within which the new contact may be
  };
  /// Where the finger shall go, in W; follows the object's reference position.
  struct Target {
    Vector3d p_WC = Vector3d::Zero();       ///< contact [m]
    Vector3d p_WF = Vector3d::Zero();       ///< fingertip centre [m]
    Vector3d normal_W = Vector3d::UnitZ();  ///< outward
    Vector3d p_WR = Vector3d::Zero();       ///< explore: the last explorations' end [m]
    Vector3d p_WO = Vector3d::Zero();  ///< the object's centre, about which a hop is an arc [m]
  };

  void Start(const Request& request);
  /// Back into the grasp by the shortest way.
  void Abort();
  /// One tick; changes the task of this finger only.
  void Update(const ControlTick& tick, const Target& target, HybridController* controller,
              FingerTasks* tasks);

  const Request& request() const { return request_; }
  Phase phase() const { return phase_; }
  bool active() const { return phase_ != Phase::kIdle && phase_ != Phase::kDone; }
  bool aborted() const { return aborted_; }
  /// Found no surface to stand on.
  bool lost() const { return lost_; }
  /// True in the tick in which the exploration begins at the target, and in which it ends.
  bool explore_began() const { return explore_began_; }
  bool explore_ended() const { return explore_ended_; }
  double phi() const { return phi_; }
  bool on_stability() const { return on_stability_; }
  const SurfaceExploration& algorithm() const { return algorithm_; }
  void AddTo(StateHasher* hasher) const;

 private:
  void Enter(Phase phase);
  void Reach(const Vector3d& velocity, double dt, FingerTask* task);
  void Explore(const ControlTick& tick, const Target& target, FingerTask* task);

  Request request_;
  Phase phase_ = Phase::kIdle;
  int ticks_ = 0;  // in this phase
  bool abort_ = false, aborted_ = false, lost_ = false;
  bool explore_began_ = false, explore_ended_ = false;
  double cap_start_ = 0;
  Vector3d p_target_W_ = Vector3d::Zero();  // of the fingertip centre, while in the air
  Vector3d normal_W_ = Vector3d::UnitZ();   // up, while in the air
  double path_ = 0;                         // in this phase [m]
  double phi_ = 0;
  bool on_stability_ = false;
  BestContact best_;
  SurfaceExploration algorithm_;
};

std::string_view Name(Regrasp::Phase phase);  ///< "unload", "lift", ...

}  // namespace regrasp
