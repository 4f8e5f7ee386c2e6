#pragma once

/// The finger gait (Sec. III b): object motion with all fingers, then one finger after the other
/// regrasps (gait_table.h), again and again, until the object has turned as far as wanted. Who
/// regrasps next and where it lands is chosen by the table (table_gait.h) or by the plan
/// (planned_gait.h), gait.plan; the phases, the object's motion and what it has turned are here.
/// A regrasp ends as it began, should gait.plan change meanwhile.

#include "core/gait/explorations.h"
#include "core/gait/forgiveness.h"
#include "core/gait/gait_choice.h"
#include "core/gait/local_manipulation.h"
#include "core/gait/planned_gait.h"
#include "core/gait/regrasp.h"
#include "core/gait/stance_search.h"
#include "core/gait/table_gait.h"
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
    bool changed = false;  ///< phase, finger or phase of the regrasp
    Refusal refused;       ///< a finger may not leave: the margin without it is too small
    bool aborted = false;  ///< a regrasp was broken off
    double error_position = 0, error_rotation = 0;  ///< object against reference, then [m, rad]
    bool regrasp_began = false, explore_began = false, explore_ended = false, regrasp_ended = false;
    template <typename V>
    void Fields(V& v) {
      v("changed", changed);
      v("refused", refused);
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
    return active() && cycle_.idle >= parameters.dare_cycles;
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
    v("cycle", cycle_);
    v("table", table_);
    v("planned", planned_);
    v("home", home_);
    v("first_stance", first_stance_);
    v("margin_wanted", margin_wanted_);
    v("search", search_);
    v("lead", lead_);
    v("manipulation", manipulation_);
    v("regrasp", regrasp_);
    v("landing", landing_);
    v("explorations", explorations_);
    v("turned_before", turned_before_);
    v("turned_until", turned_until_);
    v("turned_meanwhile", turned_meanwhile_);
    v("turned_most", turned_most_);
    v("along", along_);
    v("stale_cycles", stale_cycles_);
    v("forgiveness", forgiveness_);
    v("cycles", cycles_);
    v("regrasps", regrasps_);
    v("happened", happened_);
    v("error", error_);
  }

 private:
  void Enter(GaitPhase phase);
  /// The plan chooses, else the table: not while the others only make room for an exploring finger.
  bool planned(const ControlTick& tick) const { return tick.gait.plan && !makes_room(); }
  /// The regrasp under way, or the last one.
  bool regrasp_planned() const { return regrasp_.request().over_surface; }
  bool makes_room() const { return request_.make_room_for >= 0; }
  int opposing() const { return cycle_.order.empty() ? -1 : cycle_.order.back().finger; }
  /// Of the turn, sense included.
  Vector3d axis_W() const { return sign_ * request_.axis_W; }
  double turned_so_far() const { return sign_ * turned_before_; }
  /// The reference has turned as far as wanted, forgiven turns included.
  bool there() const {
    return !request_.continuous && turned_before_ > std::abs(request_.angle_rad) - 1e-3;
  }
  double manipulation_turned() const {
    return phase_ == GaitPhase::kObjectMotion ? manipulation_.travelled() : 0.0;
  }
  // Choosing.
  GaitSituation Situation(const ControlTick& tick, const ObjectWrench& wrench) const;
  void Take(const GaitChoice& choice, const ControlTick& tick, const ObjectWrench& wrench);
  void StartRegrasp(const GaitChoice& choice, const ControlTick& tick);
  void EndCycle(const GaitChoice& choice, const ControlTick& tick, const ObjectWrench& wrench);
  /// Every finger waits for its turn again.
  void BeginCycle(const HandModel& hand);
  /// Those whose tips can be put elsewhere.
  static FingerSet Movable(const HandModel& hand, FingerSet fingers);
  /// The first stance of a rotation, or another one by the table: true when it is found.
  bool SearchStance(const ControlTick& tick);
  /// Where the finger comes back to, from the object reference: its first contact, turned back.
  StanceContact HomeOf(int finger, const GaitParameters& parameters) const;
  Regrasp::Target TargetOf(int finger, const ObjectWrench& wrench, const ControlTick& tick) const;
  /// Preferred normal force of those that hold: may be more while the opposing finger is away,
  /// without which a push finds the least resistance [N].
  double Grip(const ControlTick& tick) const;
  /// The regrasp has gone wrong: at once where the object moves while the finger leaves.
  bool MustBreakOff(const ControlTick& tick, const ObjectWrench& wrench);
  bool Disturbed(const Estimate& estimate, const ObjectWrench& wrench, double position,
                 double rotation);
  // Turning (finger_gait_turns.cc).
  void StartMotion(const ControlTick& tick, const ObjectWrench& wrench);
  void EndMotion(const ControlTick& tick);
  /// The object turns on between two motions, while fingers regrasp.
  ObjectMotion TurnMeanwhile(const ControlTick& tick, const ObjectWrench& wrench);
  /// The reference gives up what lasts of an error, and the twist of it is booked to what was
  /// turned; `held`: at the end of a hold.
  void Forgive(const ControlTick& tick, bool held, ObjectWrench* wrench);
  /// The rotation may end: the object has come to rest where its reference is, or never will.
  bool Rests(const ControlTick& tick, const ObjectWrench& wrench);
  // One tick of a phase each.
  void UpdateStance(const ControlTick& tick, const ObjectWrench& wrench);
  ObjectMotion UpdateMotion(const ControlTick& tick, ObjectWrench* wrench);
  void UpdateChoose(const ControlTick& tick, const ObjectWrench& wrench);
  void UpdateRegrasp(const ControlTick& tick, HybridController* controller, FingerTasks* tasks);
  void UpdateRecover(const ControlTick& tick, ObjectWrench* wrench);

  Request request_;
  GaitPhase phase_ = GaitPhase::kIdle;
  int ticks_ = 0;
  bool stop_ = false;
  double sign_ = 1;
  GaitCycle cycle_;
  TableGait table_;
  PlannedGait planned_;
  Home home_;            // where each finger comes back to
  Stance first_stance_;  // where the fingers touched when the rotation began
  // Of the stance search; raised when the opposing finger is refused [N].
  double margin_wanted_ = 0;
  StanceSearch search_;
  // By how much each finger's target is turned back about the axis: half of what a motion that
  // ended at this finger's limit still wanted is added, so that it has more way the next time
  // [rad].
  std::array<double, kMaxFingers> lead_{};
  LocalManipulation manipulation_;
  Regrasp regrasp_;
  Landing landing_;  // of the regrasp; none found: the finger goes home
  Explorations explorations_;
  double turned_before_ = 0, turned_until_ = 0;  // now; when the last cycle ended [rad]
  double turned_most_ = 0;                       // at the end of any cycle [rad]
  double turned_meanwhile_ = 0;  // of the present cycle, while fingers regrasped [rad]
  TurnAlong along_;
  int stale_cycles_ = 0;  // in a row, that have turned the object no farther than ever before
  Forgiveness forgiveness_;
  int cycles_ = 0, regrasps_ = 0;
  Happened happened_;
  char error_[kReasonRoom] = {};
};

}  // namespace regrasp
