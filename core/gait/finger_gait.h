#pragma once

/// The finger gait (Sec. III b): object motion with all fingers, then one finger after the other
/// regrasps (gait_table.h), again and again, until the object has turned as far as wanted.

#include "core/gait/explored_gain.h"
#include "core/gait/forgiveness.h"
#include "core/gait/gait_table.h"
#include "core/gait/landing_plan.h"
#include "core/gait/local_manipulation.h"
#include "core/gait/regrasp.h"
#include "core/gait/stance_plan.h"
#include "core/gait/stance_search.h"
#include "core/gait/turn_along.h"

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
  kPlan,  ///< where the next finger shall land
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
    bool changed = false;     ///< phase, finger or phase of the regrasp
    int refused_finger = -1;  ///< may not leave: the margin without it is too small
    double refused_margin = 0, refused_below = 0;   ///< [N]
    bool aborted = false;                           ///< a regrasp was broken off
    double error_position = 0, error_rotation = 0;  ///< object against reference, then [m, rad]
    bool regrasp_began = false, explore_began = false, explore_ended = false, regrasp_ended = false;
    template <typename V>
    void Fields(V& v) {
      v("changed", changed);
      v("refused_finger", refused_finger, v.Finger());
      v("refused_margin", refused_margin, kUnbounded);
      v("refused_below", refused_below);
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
  /// gait.dare_cycles cycles in a row have not turned the object: more is to be counted on than is
  /// safe. The round at rest with which a gait begins is such a cycle.
  bool dares(const GaitParameters& parameters) const {
    return active() && idle_cycles_ >= parameters.dare_cycles;
  }
  /// The finger that regrasps, or -1.
  int finger() const { return phase_ == GaitPhase::kRegrasp ? regrasp_.finger() : -1; }
  const Regrasp& regrasp() const { return regrasp_; }
  const Forgiveness& forgiveness() const { return forgiveness_; }
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
    v("phase", phase_, GaitPhase::kPlan);
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
    v("turned_until", turned_until_);
    v("turned_meanwhile", turned_meanwhile_);
    v("along", along_);
    v("gain", gain_);
    v("idle_cycles", idle_cycles_);
    v("stale_cycles", stale_cycles_);
    v("turned_most", turned_most_);
    v("refused_finger", refused_finger_, v.Finger());
    v("sought", sought_);
    v("refused_margin", refused_margin_, kUnbounded);
    v("refused_below", refused_below_);
    v("plan", plan_);
    v("landing", landing_);
    v("room_for", room_for_, v.Finger());
    v("room_queue", room_queue_);
    v("stance_plan", stance_plan_);
    v("stance_queue", stance_queue_);
    v("caution", caution_);
    v("error_position", error_position_);
    v("error_rotation", error_rotation_);
    v("regrasp_began", regrasp_began_);
    v("made_room", made_room_);
    v("sought_for", sought_for_);
    v("put_off", put_off_);
    v("let_by", let_by_);
    v("misses", misses_);
    v("rubs", rubs_);
    v("forgiveness", forgiveness_);
    v("cycles", cycles_);
    v("regrasps", regrasps_);
    v("happened", happened_);
    v("error", error_);
  }

 private:
  void Enter(GaitPhase phase);
  /// Landings are planned: not while the others only make room for an exploring finger.
  bool planned(const ControlTick& tick) const {
    return tick.gait.plan && request_.make_room_for < 0;
  }
  double turned_so_far() const { return sign_ * turned_before_; }
  /// The reference has turned as far as wanted, forgiven turns included.
  bool there() const {
    return !request_.continuous && turned_before_ > std::abs(request_.angle_rad) - 1e-3;
  }
  double manipulation_turned() const {
    return phase_ == GaitPhase::kObjectMotion ? manipulation_.travelled() : 0.0;
  }
  void SearchStance(const ControlTick& tick);
  void Remember(int finger, const ControlTick& tick, const ObjectWrench& wrench);
  void StartMotion(const ControlTick& tick, const ObjectWrench& wrench);
  void EndMotion(const ControlTick& tick);
  /// Those whose tips can be put elsewhere.
  static FingerSet Movable(const HandModel& hand, FingerSet fingers);
  /// Every such finger waits for its turn again.
  void BeginCycle(const HandModel& hand);
  /// The object turns on between two motions, while fingers regrasp.
  ObjectMotion TurnMeanwhile(const ControlTick& tick, const ObjectWrench& wrench);
  /// Whether Algorithm 1 shall run where the finger lands.
  bool Explores(const ControlTick& tick, int finger) const;
  /// The same with landings planned on the felt surface: a refused finger waits; when only refused
  /// ones are left, the others make room for one of them.
  void NextPlanned(const ControlTick& tick, const ObjectWrench& wrench);
  void StartPlan(int finger, double reach, const ControlTick& tick);
  void EndPlan(const ControlTick& tick);
  Regrasp::Request RequestOf(const GaitStep& step, int next, const ControlTick& tick) const;
  /// Preferred normal force of those that hold: may be more while the opposing finger is away,
  /// without which a push finds the least resistance [N].
  double Grip(const ControlTick& tick) const;
  /// Least load margin without the finger at which it may leave [N].
  double MarginNeeded(const ControlTick& tick, int finger) const;
  /// The finger has its turn without leaving; what it lacked is kept for the report.
  void Refuse(const ControlTick& tick, int finger);
  bool MayLeave(const ControlTick& tick, int finger) const;
  void StartRegrasp(const ControlTick& tick, int finger, const Landing& landing);
  /// The stance plan is made: its contacts are taken by those that may leave.
  void EndStancePlan(const ControlTick& tick);
  /// The regrasp has gone wrong: at once where the object moves while the finger leaves.
  bool MustBreakOff(const ControlTick& tick, const ObjectWrench& wrench);
  double ReserveOf(const ControlTick& tick, int finger) const;
  bool Unsteady(const ControlTick& tick) const;
  /// The reference gives up what lasts of an error, and the twist of it is booked to what was
  /// turned; `held`: at the end of a hold.
  void Forgive(const ControlTick& tick, bool held, ObjectWrench* wrench);
  // One tick of a phase each.
  void UpdateStance(const ControlTick& tick);
  ObjectMotion UpdateMotion(const ControlTick& tick, ObjectWrench* wrench);
  void UpdateRegrasp(const ControlTick& tick, HybridController* controller, FingerTasks* tasks);
  void UpdateRecover(const ControlTick& tick, ObjectWrench* wrench);
  /// The rotation may end: the object has come to rest where its reference is, or never will.
  bool Rests(const ControlTick& tick, const ObjectWrench& wrench);
  /// Picks the next finger that shall and may leave, or starts the next object motion.
  void Next(const ControlTick& tick, const ObjectWrench& wrench);
  void EndCycle(const ControlTick& tick, const ObjectWrench& wrench);
  /// Where the finger comes back to, from the object reference: its first contact, turned back.
  StanceContact HomeOf(int finger, const GaitParameters& parameters) const;
  Regrasp::Target TargetOf(int finger, const ObjectWrench& wrench, const ControlTick& tick) const;
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
  std::array<ExploredGain, kMaxFingers> gain_{};  // of its last explorations
  // By how much each finger's target is turned back about the axis: half of what a motion that
  // ended at this finger's limit still wanted is added, so that it has more way the next time
  // [rad].
  std::array<double, kMaxFingers> lead_{};
  LocalManipulation manipulation_;
  Regrasp regrasp_;
  FingerSet waiting_;  // the fingers that have not had their turn in this cycle
  double turned_before_ = 0, turned_until_ = 0;  // now; when the last cycle ended [rad]
  double turned_most_ = 0;                       // at the end of any cycle [rad]
  double turned_meanwhile_ = 0;  // of the present cycle, while fingers regrasped [rad]
  TurnAlong along_;
  int idle_cycles_ = 0, stale_cycles_ = 0;
  static constexpr int kStale = 3;  // times gait.patience: cycles that turn the object no further
  int refused_finger_ = -1;         // in this cycle
  bool sought_ = false;             // another stance, in this cycle
  double refused_margin_ = 0, refused_below_ = 0;
  LandingPlan plan_;
  std::array<Landing, kMaxFingers> landing_{};  // the last one of each finger
  int room_for_ = -1;                           // the finger for which the others make room now
  FingerSet room_queue_;                        // that have not tried yet
  StancePlan stance_plan_;
  FingerSet stance_queue_;  // fingers that shall take their place in it
  // Load margin asked for beyond gait.margin_min, after a load transfer that moved the object [N].
  std::array<double, kMaxFingers> caution_{};
  double error_position_ = 0, error_rotation_ = 0;  // when the regrasp began [m, rad]
  bool regrasp_began_ = false;
  FingerSet made_room_, sought_for_;  // in this cycle, for which fingers
  FingerSet let_by_;                  // were put off until the last regrasp of another
  FingerSet put_off_;  // others stood where they would land, and none has moved since
  int rubs_ = 0;       // fingers that have slid before they left
  int misses_ = 0;     // in a row
  Forgiveness forgiveness_;
  int cycles_ = 0, regrasps_ = 0;
  Happened happened_;
  char error_[160] = {};
};

}  // namespace regrasp
