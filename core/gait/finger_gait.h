#pragma once

/// The finger gait (Sec. III b): object motion with all fingers, then one finger after the other
/// regrasps (gait_table.h), again and again, until the object has turned as far as wanted.

#include "core/gait/gait_table.h"
#include "core/gait/local_manipulation.h"
#include "core/gait/regrasp.h"
#include "core/gait/stance_search.h"

namespace regrasp {

/// States of the gait; GaitFrame::phase.
enum class GaitPhase : std::uint8_t {
  kIdle,
  kStance,  ///< all fingers hold; contacts are sought from which the opposing finger may leave
  kObjectMotion,  ///< all fingers hold, the object turns
  kSettle,        ///< all fingers hold
  kChoose,        ///< which finger comes next
  kRegrasp,       ///< S_L, S_R, ...: one finger moves, the others hold
  kRecover,       ///< a regrasp was broken off: all fingers hold until the object is back
  kFinish,        ///< the object comes to rest
  kDone,
  kFailed,
};
std::string_view Name(GaitPhase phase);  ///< "object motion", ...

class FingerGait {
 public:
  struct Request {
    double angle_rad = 0;  ///< signed
    bool continuous = false;
    Vector3d axis_W = Vector3d::UnitZ();
    double speed_rad_s = 0;  ///< 0: the parameter's
    std::uint64_t seed = 0;
    /// >= 0: no rotation; the others shift their contacts until this finger may leave (S_F).
    int make_room_for = -1;
    template <typename V>
    void Fields(V& v) {
      v("angle_rad", angle_rad);
      v("continuous", continuous);
      v("axis_W", axis_W);
      v("speed_rad_s", speed_rad_s);
      v("seed", seed);
      v("make_room_for", make_room_for, v.Finger());
    }
  };
  /// What happened in the last Update.
  struct Happened {
    bool changed = false;       ///< phase, finger or phase of the regrasp
    int refused_finger = -1;    ///< may not leave: the margin without it is too small
    double refused_margin = 0;  ///< [N]
    bool aborted = false;       ///< a regrasp was broken off
    double error_position = 0, error_rotation = 0;  ///< object against reference, then [m, rad]
    bool regrasp_began = false, explore_began = false, explore_ended = false, regrasp_ended = false;
    template <typename V>
    void Fields(V& v) {
      v("changed", changed);
      v("refused_finger", refused_finger, v.Finger());
      v("refused_margin", refused_margin, kUnbounded);
      v("aborted", aborted);
      v("error_position", error_position);
      v("error_rotation", error_rotation);
      v("regrasp_began", regrasp_began);
      v("explore_began", explore_began);
      v("explore_ended", explore_ended);
      v("regrasp_ended", regrasp_ended);
    }
  };

  /// The present contacts are the gait's first ones.
  void Start(const Request& request, const ControlTick& tick, const ObjectWrench& wrench);
  /// All fingers into a hold, at once; then kDone.
  void Stop();
  /// One tick: sets the task of every finger of the grasp, returns the object's motion.
  ObjectMotion Update(const ControlTick& tick, HybridController* controller, FingerTasks* tasks);

  GaitPhase phase() const { return phase_; }
  bool active() const {
    return phase_ != GaitPhase::kIdle && phase_ != GaitPhase::kDone && phase_ != GaitPhase::kFailed;
  }
  bool stopped() const { return stop_; }
  /// The finger that regrasps, or -1.
  int finger() const { return phase_ == GaitPhase::kRegrasp ? regrasp_.finger() : -1; }
  const Regrasp& regrasp() const { return regrasp_; }
  const LocalManipulation& manipulation() const { return manipulation_; }
  const Happened& happened() const { return happened_; }
  /// Of the object reference about the axis, signed [rad].
  double turned() const { return sign_ * (turned_before_ + manipulation_turned()); }
  double target() const { return request_.angle_rad; }
  const Request& request() const { return request_; }
  int cycles() const { return cycles_; }
  int regrasps() const { return regrasps_; }
  /// Why it failed: one plain sentence, empty unless kFailed.
  const char* error() const { return error_; }
  template <typename V>
  void Fields(V& v) {
    v("request", request_);
    v("phase", phase_, GaitPhase::kFailed);
    v("ticks", ticks_);
    v("stop", stop_);
    v("sign", sign_);
    v("order", order_);
    v("home", home_);
    v("first_stance", first_stance_);
    v("margin_wanted", margin_wanted_);
    v("searches", searches_);
    v("search", search_);
    v("found", found_);
    v("gradient", gradient_);
    v("lead", lead_);
    v("manipulation", manipulation_);
    v("regrasp", regrasp_);
    v("waiting", waiting_);
    v("turned_before", turned_before_);
    v("turned_in_cycle", turned_in_cycle_);
    v("idle_cycles", idle_cycles_);
    v("refused_finger", refused_finger_, v.Finger());
    v("sought", sought_);
    v("refused_margin", refused_margin_, kUnbounded);
    v("cycles", cycles_);
    v("regrasps", regrasps_);
    v("happened", happened_);
    v("error", error_);
  }

 private:
  void Enter(GaitPhase phase);
  double manipulation_turned() const {
    return phase_ == GaitPhase::kObjectMotion ? manipulation_.travelled() : 0.0;
  }
  void SearchStance(const ControlTick& tick);
  void Remember(int finger, const ControlTick& tick, const ObjectWrench& wrench);
  void StartMotion(const GaitParameters& parameters);
  void EndMotion();
  /// Picks the next finger that shall and may leave, or starts the next object motion.
  void Next(const ControlTick& tick, const ObjectWrench& wrench);
  void EndCycle(const ControlTick& tick);
  /// Where the finger comes back to, from the object reference: its first contact, turned back.
  StanceContact HomeOf(int finger, const GaitParameters& parameters) const;
  Regrasp::Target TargetOf(int finger, const ObjectWrench& wrench,
                           const GaitParameters& parameters) const;
  /// How much of the exploring disc is free: all of it while the grasp without the opposing finger
  /// has the load margin that is wanted, nothing where it has hardly the one that is needed.
  double DiscShare(const ControlTick& tick) const;
  bool Disturbed(const Estimate& estimate, const ObjectWrench& wrench, double position,
                 double rotation);

  Request request_;
  GaitPhase phase_ = GaitPhase::kIdle;
  int ticks_ = 0;
  bool stop_ = false;
  double sign_ = 1;
  GaitOrder order_;
  Home home_;            // where each finger comes back to
  Stance first_stance_;  // where the fingers touched when the rotation began
  // Of the stance search; raised when the opposing finger is refused [N].
  double margin_wanted_ = 0;
  int searches_ = 0;
  StanceSearch search_;
  // Exploring: where Algorithm 1 ended the last times, from the first contact, in W axes [m]. The
  // next exploration of the finger goes there from the first contact, then Algorithm 1 takes over.
  std::array<Vector3d, kMaxFingers> found_ = ZeroVectors<kMaxFingers>();
  // The gradient with which its last exploration ended, in W [1/m]; zero: none yet.
  std::array<Vector3d, kMaxFingers> gradient_ = ZeroVectors<kMaxFingers>();
  // By how much each finger's target is turned back about the axis: half of what a motion that
  // ended at this finger's limit still wanted is added, so that it has more way the next time
  // [rad].
  std::array<double, kMaxFingers> lead_{};
  LocalManipulation manipulation_;
  Regrasp regrasp_;
  FingerSet waiting_;  // the fingers that have not had their turn in this cycle
  double turned_before_ = 0, turned_in_cycle_ = 0;
  int idle_cycles_ = 0;
  int refused_finger_ = -1;  // in this cycle
  bool sought_ = false;      // another stance, in this cycle
  double refused_margin_ = 0;
  int cycles_ = 0, regrasps_ = 0;
  Happened happened_;
  char error_[160] = {};
};

}  // namespace regrasp
