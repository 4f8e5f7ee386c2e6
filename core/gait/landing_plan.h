#pragma once

/// Where a finger that leaves shall land: planned on the felt surface, a little per tick.
///
/// Candidates lie in rings about the finger's home, projected onto the felt surface. With
/// Share(x, wanted) = x / wanted, held to −1 … 1 (1 where nothing is wanted), the parameters of
/// gait.* and the constants of landing_plan.cc each is scored by
///
///   J = Share(reserve, reserve_wanted)
///       − landing_penalty (1 − Share(reserve, min(step_rad, reserve_wanted)))²
///       − landing_far_cost (distance from home / landing_far)²
///       − landing_unknown_cost · angle to what was felt − landing_penalty · (penalties)
///       + kMarginsWeight (mean + least over the other fingers k of Share(ρ without k,
///       margin_wanted))
///       + Share(ρ without the next finger, margin_wanted)
///
/// reserve: SureReserve of the coming turn; without a turn its two terms are 0. ρ: load margin of
/// the grasp with the finger there, in which a contact near an edge or on unknown ground has less
/// friction (its normal may be another). Where room is made for a finger the last two terms are
/// kRoomWeight · ρ without that finger / margin_wanted, of any size. Penalties where the finger
/// does not reach, faces the surface with its side, comes near another finger, touches the object
/// with its links, now or after the turn, or where the surface is not known. The cheap terms, all
/// but the load margins', rate all candidates; load margins only the best few.

#include "core/control/control_tick.h"
#include "core/gait/stance.h"
#include "core/hand/finger_reach.h"
#include "core/shape/felt_surface.h"

namespace regrasp {

/// A place on the object for one finger, in O.
struct Landing {
  bool found = false;
  bool stays = false;                     ///< the best is where the finger stands
  bool blocked = false;                   ///< a link of another finger is in the way
  Vector3d p_OC = Vector3d::Zero();       ///< contact [m]
  Vector3d p_OF = Vector3d::Zero();       ///< fingertip centre [m]
  Vector3d normal_O = Vector3d::UnitZ();  ///< outward
  double unknown = 0;                     ///< angle to the nearest felt direction [rad]
  double reserve = 0;                     ///< [rad]
  double gain = 0;                        ///< in J over staying; J where the finger stands nowhere
  double score = 0;                       ///< J
  double margin = 0;  ///< ρ without the finger for which room is made, where there is one [N]
  template <typename V>
  void Fields(V& v) {
    v("found", found);
    v("stays", stays);
    v("blocked", blocked);
    v("p_OC", p_OC);
    v("p_OF", p_OF);
    v("normal_O", normal_O);
    v("unknown", unknown);
    v("reserve", reserve);
    v("gain", gain);
    v("score", score);
    v("margin", margin);
  }
};

class LandingPlan {
 public:
  struct Request {
    int finger = -1;
    StanceContact home;                   ///< from the object's centre, in W axes
    Vector3d axis_W = Vector3d::UnitZ();  ///< of the coming turn, sense included; zero: none
    int next = -1;                        ///< the finger that leaves after it, or -1
    int room_for = -1;     ///< >= 0: of the load margins only that without this finger counts
    double reach = 0.010;  ///< candidates lie so far about home [m]
    template <typename V>
    void Fields(V& v) {
      v("finger", finger, v.Finger());
      v("home", home);
      v("axis_W", axis_W);
      v("next", next, v.Finger());
      v("room_for", room_for, v.Finger());
      v("reach", reach);
    }
  };
  void Start(const Request& request);
  /// A slice of some 50 us. True once the plan is made.
  bool Step(const ControlTick& tick);
  const Request& request() const { return request_; }
  const Landing& landing() const { return best_; }
  /// Links of other fingers are in the way where it would land best by the terms that are cheap.
  bool crowded() const { return crowded_; }
  template <typename V>
  void Fields(V& v) {
    v("request", request_);
    v("next", next_, FieldRange{0, kCandidates});
    v("shortlist", shortlist_);
    v("examined", examined_, FieldRange{0, kShortlist});
    v("without", without_, FieldRange{0, kMaxFingers});
    v("sum", sum_);
    v("least", least_);
    v("after", after_);
    v("count", count_);
    v("stay_score", stay_score_);
    v("best", best_);
    v("crowded", crowded_);
  }

 private:
  static constexpr int kCandidates = 1 + 8 + 12 + 16 + 24;
  static constexpr int kShortlist = 7;

  struct Candidate {
    Landing landing;
    double friction = 0;  // coefficient that its uncertain normal leaves
    template <typename V>
    void Fields(V& v) {
      v("landing", landing);
      v("friction", friction);
    }
  };
  Candidate Rate(const ControlTick& tick, int index) const;
  /// Where the finger stands.
  Candidate Stay(const ControlTick& tick) const;
  /// Of a landing with the finger at `there`; fills in its reserve and whether it is blocked.
  double CheapScore(const ControlTick& tick, const FingerPosture& there, Landing* landing) const;
  void Remember(const Candidate& candidate);
  /// One load margin more of the candidate under examination; true when it is fully rated.
  bool Examine(const ControlTick& tick);

  Request request_;
  int next_ = 0;                                  // candidate that is rated next
  FixedVector<Candidate, kShortlist> shortlist_;  // best first
  int examined_ = 0;                              // of the shortlist
  int without_ = 0;                               // the finger whose absence is examined next
  double sum_ = 0, least_ = 0, after_ = 0;        // shares of the load margin so far
  int count_ = 0;
  double stay_score_ = 0;  // J of staying, where the finger stands
  Landing best_;
  bool crowded_ = false;
};

}  // namespace regrasp
