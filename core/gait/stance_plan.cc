#include "core/gait/stance_plan.h"

#include "core/gait/gait_parameters.h"
#include "core/gait/sure_grasp.h"
#include "core/quality/load_margin.h"

namespace regrasp {
namespace {

constexpr std::uint64_t kStream = 2100;
constexpr int kReachSteps = 6;

}  // namespace

void StancePlan::Start(const ControlTick& tick, int leaves, double reach, std::uint64_t seed) {
  *this = StancePlan();
  leaves_ = leaves;
  reach_ = reach;
  random_ = RandomStream(seed, kStream);
  const Estimate& estimate = tick.estimate;
  const Quaterniond q_OW = estimate.q_WO.conjugate();
  for (int i : tick.grasp) {
    const FingerEstimate& f = tick.finger(i);
    Landing& landing = first_[i];
    landing.found = true;
    landing.p_OC = q_OW * (f.p_WC - estimate.p_WO);
    landing.p_OF = q_OW * (f.p_WF - estimate.p_WO);
    landing.normal_O = q_OW * f.normal_W;
  }
  best_ = first_;
  first_margin_ = margin_ = MarginOf(tick, best_);
}

double StancePlan::MarginOf(const ControlTick& tick, const Landings& landings) const {
  const Estimate& estimate = tick.estimate;
  Grasp grasp;
  for (int i : tick.grasp.without(leaves_)) {
    const Landing& landing = landings[i];
    const double tilt = tick.gait.doubt * tick.felt.BendAt(landing.p_OC);
    grasp.push_back({estimate.q_WO * landing.p_OC, -(estimate.q_WO * landing.normal_O),
                     FrictionUnderTilt(tick.control.friction_estimate, tilt)});
  }
  return SignedLoadMargin({grasp.data(), grasp.size()}, tick.control.mass_estimate * tick.gravity_W,
                          estimate.object_scale, tick.control.max_normal_force);
}

bool StancePlan::Move(const ControlTick& tick, int finger, Landings* trial) {
  const Estimate& estimate = tick.estimate;
  Landing& landing = (*trial)[finger];
  const Vector3d step = TangentPart(tick.gait.stance_step * random_.Normal3(), landing.normal_O);
  const SurfacePoint surface = tick.felt.At(landing.p_OC + step);
  if (surface.unknown > tick.gait.stance_unknown ||
      (surface.p_O - first_[finger].p_OC).norm() > reach_)
    return false;
  const Vector3d p_OF = surface.p_O + tick.hand.fingers[finger].tip_radius * surface.normal_O;
  const Vector3d p_WF = estimate.p_WO + estimate.q_WO * p_OF;
  const FingerPosture now = PostureAt(tick.hand, finger, AnglesOf(tick.hand, finger, estimate.q));
  const FingerPosture there = ReachFor(tick.hand, finger, now, p_WF, tick.gait.stance_limit_margin,
                                       kReachSteps, tick.control.reach);
  if ((there.p_WF - p_WF).norm() > tick.gait.landing_missing) return false;
  for (int i : tick.grasp.without(finger)) {
    const double apart = tick.hand.fingers[finger].tip_radius + tick.hand.fingers[i].tip_radius;
    if (((*trial)[i].p_OF - p_OF).norm() < apart + tick.gait.landing_clearance) return false;
  }
  landing.p_OC = surface.p_O;
  landing.p_OF = p_OF;
  landing.normal_O = surface.normal_O;
  landing.unknown = surface.unknown;
  return true;
}

bool StancePlan::Step(const ControlTick& tick) {
  if (margin_ >= tick.gait.margin_wanted || trials_ >= tick.gait.stance_trials) return true;
  ++trials_;
  Landings trial = best_;
  bool moved = false;
  for (int i : tick.grasp.without(leaves_))
    if (random_.Uniform() < tick.gait.stance_moves) moved |= Move(tick, i, &trial);
  if (!moved) return false;
  const double margin = MarginOf(tick, trial);
  if (margin <= margin_) return false;
  margin_ = margin;
  best_ = trial;
  return false;
}

}  // namespace regrasp
