#pragma once

/// The finger gait with landings planned on the felt surface (gait.plan; ours): who may leave,
/// where it lands, and how the others make room for one that may not.
///
/// The fingers of the table regrasp in its order, each where landing_plan.h has it, if that is
/// worth leaving for. One that may not leave waits until the others have had their turn. When only
/// such fingers are left and one of them must come along, the others make room for the one nearest
/// to leaving: first one after the other, then as a whole stance (stance_plan.h). What does not
/// help is tried with less load margin after each cycle that has not turned the object, down to
/// gait.margin_least.

#include "core/gait/gait_choice.h"
#include "core/gait/regrasp.h"
#include "core/gait/stance_plan.h"

namespace regrasp {

class PlannedGait {
 public:
  /// Every finger waits for its turn again.
  void BeginCycle();
  /// What comes next: a finger that leaves, a plan, room for a refused one.
  GaitChoice Next(const ControlTick& tick, const GaitSituation& now, GaitCycle* cycle);
  /// One tick of the plan of a landing (GaitChoice::kPlan): kWait until it is made.
  GaitChoice Plan(const ControlTick& tick, GaitCycle* cycle);
  /// One tick of the plan of a stance (GaitChoice::kStance): kWait until it is made.
  GaitChoice PlanStance(const ControlTick& tick);
  /// A stance has been planned in this rotation.
  bool plans_stance() const { return stance_plan_.leaves() >= 0; }
  /// A planned regrasp has gone wrong while its finger leaves: another one slips, or the object is
  /// off its reference by more than when the finger began, `error_position` [m] and
  /// `error_rotation` [rad] now. It is to be broken off, and more caution taken the next time.
  bool MustBreakOff(const ControlTick& tick, const Regrasp& regrasp, double error_position,
                    double error_rotation);
  /// A planned regrasp has ended. False: too many in a row have found no surface, the gait gives
  /// up.
  bool Ended(const ControlTick& tick, const Regrasp& regrasp, GaitCycle* cycle);
  template <typename V>
  void Fields(V& v) {
    v("plan", plan_);
    v("room_for", room_for_, v.Finger());
    v("room_queue", room_queue_);
    v("stance_plan", stance_plan_);
    v("stance_queue", stance_queue_);
    v("caution", caution_);
    v("leaving", leaving_);
    v("error_position", error_position_);
    v("error_rotation", error_rotation_);
    v("made_room", made_room_);
    v("sought_for", sought_for_);
    v("put_off", put_off_);
    v("let_by", let_by_);
    v("misses", misses_);
    v("rubs", rubs_);
  }

 private:
  /// Least load margin without the finger at which it may leave [N]. Without progress it is tried
  /// with less: the load transfer is careful, and ends in time.
  double MarginNeeded(const ControlTick& tick, int finger, const GaitCycle& cycle) const;
  bool MayLeaveNow(const ControlTick& tick, int finger, const GaitCycle& cycle) const {
    return MayLeave(tick, finger, MarginNeeded(tick, finger, cycle));
  }
  /// The others make room for `room_for_`: the next of them, or kWait when none is left.
  GaitChoice NextForRoom(const ControlTick& tick, const GaitSituation& now, const GaitCycle& cycle);
  /// Only fingers that may not leave are left: what is done for the one nearest to leaving.
  GaitChoice ForRefused(const ControlTick& tick, const GaitSituation& now, GaitCycle* cycle);
  GaitChoice StartPlan(int finger, double reach, const GaitSituation& now, const GaitCycle& cycle);
  GaitChoice RegraspOf(const ControlTick& tick, int finger, const Landing& landing) const;

  static constexpr int kStale = 3;  // times gait.patience: cycles that turn the object no further

  LandingPlan plan_;
  int room_for_ = -1;     // the finger for which the others make room now
  FingerSet room_queue_;  // that have not tried yet
  StancePlan stance_plan_;
  FingerSet stance_queue_;  // fingers that shall take their place in it
  // Load margin asked for beyond gait.margin_min, after a load transfer that moved the object [N].
  std::array<double, kMaxFingers> caution_{};
  bool leaving_ = false;                            // a regrasp has begun, with these errors:
  double error_position_ = 0, error_rotation_ = 0;  // [m, rad]
  FingerSet made_room_, sought_for_;                // in this cycle, for which fingers
  FingerSet let_by_;                                // were put off until another's last regrasp
  FingerSet put_off_;  // others stood where they would land, and none has moved since
  int rubs_ = 0;       // fingers that have slid before they left
  int misses_ = 0;     // landings in a row that found no surface
};

}  // namespace regrasp
