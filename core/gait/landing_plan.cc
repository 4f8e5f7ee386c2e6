#include "core/gait/landing_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/exploration/exploration_parameters.h"
#include "core/gait/gait_parameters.h"
#include "core/gait/sure_grasp.h"
#include "core/gait/sure_reserve.h"
#include "core/hand/box_gap.h"
#include "core/hand/shape_distance.h"
#include "core/quality/load_margin.h"

namespace regrasp {
namespace {

constexpr int kReachSteps = 8;
constexpr double kNearObject = 1.8;  // of the mean radius: a link farther out is clear of it

// Of the score J (landing_plan.h).
constexpr double kMarginsWeight = 0.5;  // of the mean and of the least of the load margins' shares
constexpr double kRoomWeight = 3;       // of the load margin without the finger that gets room
constexpr double kMostUnknown = 0.5;  // angle to what was felt that tilts the normal, at most [rad]
constexpr double kMissingPenalty = 0.01;  // so far from its target a tip costs a penalty more [m]
constexpr double kNearPenalty = 0.002;    // a gap so much smaller than wanted costs a penalty [m]
constexpr double kMostNear = 5.0;         // penalties for what is too near another finger
constexpr double kMostTouching = 1.5;     // penalties for what touches the object beside the tip

double Square(double x) { return x * x; }

/// Candidate `index` as an offset from home in its tangent plane, in units of the reach.
Eigen::Vector2d RingOffset(int index) {
  constexpr std::array<int, 4> kCounts{8, 12, 16, 24};
  if (index == 0) return Eigen::Vector2d::Zero();
  --index;
  for (std::size_t ring = 0; ring < kCounts.size(); ++ring) {
    if (index < kCounts[ring]) {
      const double radius = 0.25 * static_cast<double>(ring + 1);
      const double angle = 2 * std::numbers::pi * index / kCounts[ring];
      return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    index -= kCounts[ring];
  }
  return Eigen::Vector2d::Zero();
}

/// Between a link and the felt surface, at most gait.link_clearance; negative where they overlap
/// [m]. `q_OW`: of the object, for the place where it is sensed.
double GapToObject(const Bones& bones, const ControlTick& tick, const Quaterniond& q_OW) {
  const FeltSurface& felt = tick.felt;
  double gap = tick.gait.link_clearance;
  for (const Bone& bone : bones)
    for (const double share : {0.0, 0.5, 1.0}) {
      const Vector3d r = bone.a_W + share * (bone.b_W - bone.a_W) - tick.estimate.p_WO;
      const double distance = r.norm();
      if (distance > kNearObject * felt.mean_radius() + bone.radius || distance < 1e-6) continue;
      const SurfacePoint surface = felt.At(q_OW * r);
      const double slope =
          std::max(tick.gait.least_slope, surface.normal_O.dot(surface.p_O) / surface.p_O.norm());
      gap = std::min(gap, (distance - surface.p_O.norm()) * slope - bone.radius);
    }
  return gap;
}

/// Between what the last link has beside its round fingertip and the object, which
/// stands for a ball as large as the grasp that the fingertip touches at `p_OC`; at most
/// gait.link_clearance [m]. `turn`: of the object and the finger [W].
double GapBeside(const ControlTick& tick, int finger, const FingerPosture& there,
                 const Landing& landing, const Quaterniond& turn) {
  const double radius = tick.estimate.object_scale;
  const Vector3d middle_O = landing.p_OC - radius * landing.normal_O;
  const Vector3d middle_W = tick.estimate.p_WO + turn * (tick.estimate.q_WO * middle_O);
  return GapBesideTip(tick.hand.links[tick.hand.fingers[finger].tip_link], there.X_WT, middle_W,
                      radius, tick.gait.link_clearance);
}

/// For what of a finger is not its round tip, where it would touch the object: there, or once the
/// object has turned by `turn` [rad, rotation vector in W].
double LinkPenalty(const ControlTick& tick, int finger, const FingerPosture& there,
                   const Landing& landing, const Vector3d& turn_W) {
  const Vector3d& p_WO = tick.estimate.p_WO;
  const Quaterniond q_OW = tick.estimate.q_WO.conjugate();
  double gap = std::min(GapToObject(there.middle, tick, q_OW),
                        GapBeside(tick, finger, there, landing, Quaterniond::Identity()));
  if (!turn_W.isZero()) {
    const Quaterniond turn = FromRotationVector(turn_W);
    const Vector3d p_WF = p_WO + turn * (there.p_WF - p_WO);
    const FingerPosture turned =
        ReachFor(tick.hand, finger, there, p_WF, 0.0, kReachSteps, tick.control.reach);
    gap = std::min({gap, GapToObject(turned.middle, tick, q_OW * turn.conjugate()),
                    GapBeside(tick, finger, turned, landing, turn)});
  }
  return tick.gait.landing_penalty *
         std::min(kMostTouching, (tick.gait.link_clearance - gap) / tick.gait.link_touches);
}

/// The coming turn, as far as the finger follows [rad, rotation vector in W].
Vector3d TurnAhead(const ControlTick& tick, const LandingPlan::Request& request, double reserve) {
  return std::min(reserve, tick.gait.step_rad) * request.axis_W;
}

/// The last two links of a finger.
struct OuterLinks {
  FixedVector<Bone, 5> bones;
  Boxes boxes;
};

OuterLinks OuterLinksOf(const HandModel& hand, int finger, const FingerPosture& posture) {
  OuterLinks links;
  links.bones.push_back(posture.tip);
  for (const Bones* some : {&posture.middle, &posture.body})
    for (const Bone& bone : *some) links.bones.push_back(bone);
  links.boxes = BoxesOf(hand, finger, posture);
  return links;
}

/// Between the last two links of two fingers [m].
double GapOfFingers(const OuterLinks& one, const OuterLinks& two) {
  double gap = 1;
  for (const Bone& a : one.bones)
    for (const Bone& b : two.bones) gap = std::min(gap, Gap(a, b));
  for (const PlacedBox& a : one.boxes) {
    for (const Bone& b : two.bones) gap = std::min(gap, Gap(a, b));
    for (const PlacedBox& b : two.boxes) gap = std::min(gap, Gap(a, b));
  }
  for (const PlacedBox& b : two.boxes)
    for (const Bone& a : one.bones) gap = std::min(gap, Gap(b, a));
  return gap;
}

double Share(double value, double wanted) {
  return wanted > 0 ? std::clamp(value / wanted, -1.0, 1.0) : 1.0;
}

}  // namespace

void LandingPlan::Start(const Request& request) {
  *this = LandingPlan();
  request_ = request;
}

LandingPlan::Candidate LandingPlan::Rate(const ControlTick& tick, int index) const {
  const HandModel& hand = tick.hand;
  const Estimate& estimate = tick.estimate;
  const int finger = request_.finger;
  const Matrix3d R_home = RotationFromZ(request_.home.normal_W);
  const Eigen::Vector2d offset = request_.reach * RingOffset(index);
  const Vector3d aim_W = request_.home.p_OC_W + R_home.leftCols<2>() * offset;
  const Quaterniond q_OW = estimate.q_WO.conjugate();
  const SurfacePoint surface = tick.felt.At(q_OW * aim_W);

  Candidate candidate;
  Landing& landing = candidate.landing;
  landing.found = true;
  landing.p_OC = surface.p_O;
  landing.normal_O = surface.normal_O;
  landing.p_OF = surface.p_O + hand.fingers[finger].tip_radius * surface.normal_O;
  landing.unknown = surface.unknown;
  const double tilt = tick.gait.doubt * surface.bend +
                      tick.gait.landing_unknown_share * std::min(kMostUnknown, surface.unknown);
  candidate.friction = FrictionUnderTilt(tick.control.friction_estimate, tilt);

  const Vector3d p_WF = estimate.p_WO + estimate.q_WO * landing.p_OF;
  const FingerPosture now = PostureAt(hand, finger, AnglesOf(hand, finger, estimate.q));
  const FingerPosture there = ReachFor(hand, finger, now, p_WF, tick.gait.landing_limit_margin,
                                       kReachSteps, tick.control.reach);
  const double missing = (there.p_WF - p_WF).norm();
  landing.score = CheapScore(tick, there, &landing) -
                  tick.gait.landing_far_cost * offset.squaredNorm() / Square(tick.gait.landing_far);
  if (missing > tick.gait.landing_missing)
    landing.score -= tick.gait.landing_penalty * (1 + missing / kMissingPenalty);
  const bool listed =
      !shortlist_.full() || landing.score > shortlist_[shortlist_.size() - 1].landing.score;
  if (listed)
    landing.score -=
        LinkPenalty(tick, finger, there, landing, TurnAhead(tick, request_, landing.reserve));
  return candidate;
}

double LandingPlan::CheapScore(const ControlTick& tick, const FingerPosture& there,
                               Landing* landing) const {
  const HandModel& hand = tick.hand;
  const Estimate& estimate = tick.estimate;
  const int finger = request_.finger;
  const double penalty = tick.gait.landing_penalty, clearance = tick.gait.landing_clearance;
  const double unknown = landing->unknown;
  double score = -tick.gait.landing_unknown_cost * unknown -
                 penalty * std::max(0.0, unknown - tick.gait.landing_known);
  const double facing = there.along_W.dot(estimate.q_WO * landing->normal_O);
  if (facing > tick.exploration.least_facing)
    score -= penalty * (facing - tick.exploration.least_facing);
  double gap = clearance;
  const OuterLinks mine = OuterLinksOf(hand, finger, there);
  for (int i : tick.grasp.without(finger)) {
    const FingerPosture other = PostureAt(hand, i, AnglesOf(hand, i, estimate.q));
    gap = std::min(gap, GapOfFingers(mine, OuterLinksOf(hand, i, other)));
  }
  if (gap < clearance) score -= penalty * std::min(kMostNear, (clearance - gap) / kNearPenalty);
  landing->blocked = gap < -tick.gait.landing_overlap;
  if (!request_.axis_W.isZero()) {
    landing->reserve =
        SureReserve(hand, finger, there, estimate.p_WO, request_.axis_W, tick.gait.limit_margin,
                    tick.gait.reserve_wanted, tick.control.reach);
    score += Share(landing->reserve, tick.gait.reserve_wanted);
    // The finger with the least reserve ends the coming motion for all of them.
    const double short_of =
        1 - Share(landing->reserve, std::min(tick.gait.step_rad, tick.gait.reserve_wanted));
    score -= penalty * short_of * short_of;
  }
  return score;
}

LandingPlan::Candidate LandingPlan::Stay(const ControlTick& tick) const {
  const FingerEstimate& f = tick.finger(request_.finger);
  const Quaterniond q_OW = tick.estimate.q_WO.conjugate();
  Candidate candidate;
  Landing& landing = candidate.landing;
  landing.found = landing.stays = true;
  landing.p_OC = q_OW * (f.p_WC - tick.estimate.p_WO);
  landing.p_OF = q_OW * (f.p_WF - tick.estimate.p_WO);
  landing.normal_O = q_OW * f.normal_W;
  candidate.friction = FrictionUnderTilt(tick.control.friction_estimate,
                                         tick.gait.doubt * tick.felt.BendAt(landing.p_OC));
  const FingerPosture now =
      PostureAt(tick.hand, request_.finger, AnglesOf(tick.hand, request_.finger, tick.estimate.q));
  landing.score =
      CheapScore(tick, now, &landing) -
      LinkPenalty(tick, request_.finger, now, landing, TurnAhead(tick, request_, landing.reserve));
  const double far2 =
      TangentPart(f.p_WC - tick.estimate.p_WO - request_.home.p_OC_W, request_.home.normal_W)
          .squaredNorm();
  landing.score -= tick.gait.landing_far_cost * far2 / Square(tick.gait.landing_far);
  return candidate;
}

void LandingPlan::Remember(const Candidate& candidate) {
  std::size_t place = shortlist_.size();
  if (!shortlist_.push_back(candidate)) {
    place = shortlist_.size() - 1;
    if (candidate.landing.score <= shortlist_[place].landing.score) return;
    shortlist_[place] = candidate;
  }
  for (; place > 0 && shortlist_[place].landing.score > shortlist_[place - 1].landing.score;
       --place)
    std::swap(shortlist_[place], shortlist_[place - 1]);
}

bool LandingPlan::Examine(const ControlTick& tick) {
  const Candidate& candidate = shortlist_[examined_];
  const Estimate& estimate = tick.estimate;
  while (without_ < tick.hand.num_fingers() &&
         (without_ == request_.finger || !tick.grasp.contains(without_) ||
          (request_.room_for >= 0 && without_ != request_.room_for)))
    ++without_;
  if (without_ >= tick.hand.num_fingers()) return true;
  const FingerSet rest = tick.grasp.without(without_).without(request_.finger);
  Grasp grasp =
      SureGraspOf(estimate, rest, tick.control.friction_estimate, tick.felt, tick.gait.doubt);
  grasp.push_back({estimate.q_WO * candidate.landing.p_OC,
                   -(estimate.q_WO * candidate.landing.normal_O), candidate.friction});
  const double margin =
      SignedLoadMargin({grasp.data(), grasp.size()}, tick.control.mass_estimate * tick.gravity_W,
                       estimate.object_scale, tick.control.max_normal_force);
  if (without_ == request_.room_for) shortlist_[examined_].landing.margin = margin;
  const double share = Share(margin, tick.gait.margin_wanted);
  sum_ += share;
  least_ = count_ == 0 ? share : std::min(least_, share);
  if (without_ == request_.next) after_ = share;
  ++count_;
  ++without_;
  return false;
}

bool LandingPlan::Step(const ControlTick& tick) {
  if (next_ < kCandidates) {
    Remember(Rate(tick, next_++));  // a tick has room for one
    if (next_ == kCandidates) crowded_ = shortlist_[0].landing.blocked;
    if (next_ == kCandidates && tick.finger(request_.finger).ticks_without_contact == 0) {
      // Staying is examined in any case.
      if (shortlist_.full()) shortlist_.resize(kShortlist - 1);
      shortlist_.push_back(Stay(tick));
    }
    return false;
  }
  if (examined_ < static_cast<int>(shortlist_.size())) {
    if (!Examine(tick)) return false;
    Landing landing = shortlist_[examined_].landing;
    if (request_.room_for >= 0) {
      landing.score += kRoomWeight * landing.margin / std::max(1e-3, tick.gait.margin_wanted);
    } else if (count_ > 0) {
      landing.score += kMarginsWeight * (sum_ / count_ + least_) + after_;
    }
    if (!best_.found || landing.score > best_.score) best_ = landing;
    if (landing.stays) stay_score_ = landing.score;
    ++examined_;
    without_ = count_ = 0;
    sum_ = least_ = after_ = 0;
    return false;
  }
  best_.gain = best_.score - stay_score_;
  return true;
}

}  // namespace regrasp
