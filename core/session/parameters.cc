#include "core/session/parameters.h"

#include <algorithm>
#include <array>

#include "core/hand/scenario.h"

namespace regrasp {
namespace {

using P = Parameters;
constexpr std::string_view kOurs = "ours";
constexpr std::string_view kMeasured = "ours, measured";
constexpr std::string_view kPaper = "paper";

// clang-format off
// name | unit | min | max | size | meaning | source | member.            Sorted by name.
constexpr auto kTable = std::to_array<ParameterInfo>({
  {"control.close_force", "N", 0.02, 2, 1, "A finger that has touched while the hand closes waits with this force.", kOurs, [](P& p) { return &p.control.close_force; }},
  {"control.close_speed", "rad/s", 0.05, 3, 1, "Speed of the fastest joint while the hand closes.", kOurs, [](P& p) { return &p.control.close_speed; }},
  {"control.contact_filter_s", "s", 0, 1, 1, "Time constant of the low pass on contact points and normals, in the fingertip's frame.", kMeasured, [](P& p) { return &p.control.contact_filter_s; }},
  {"control.contact_from_normal", "", 0, 1, 1, "1: place a contact on the fingertip's known surface by its sensed normal; 0: trust the sensed position alone.", kMeasured, [](P& p) { return &p.control.contact_from_normal; }},
  {"control.drop_distance", "m", 0.005, 0.5, 1, "An object sensed this far from where control wants it counts as dropped.", kOurs, [](P& p) { return &p.control.drop_distance; }},
  {"control.fingertip_stiffness", "N/m", 100, 1e9, 1, "A fingertip is pressed in by its normal force over this; places the contact on it.", "the hand's: docs/world.md", [](P& p) { return &p.control.fingertip_stiffness; }},
  {"control.force_filter_s", "s", 0, 1, 1, "Time constant of the low pass on contact forces.", kMeasured, [](P& p) { return &p.control.force_filter_s; }},
  {"control.force_integral_limit", "N", 0, 20, 1, "Largest change of the integrated object force from its start value, per axis.", kMeasured, [](P& p) { return &p.control.force_integral_limit; }},
  {"control.friction_estimate", "", 0.05, 1, 1, "Friction coefficient the force distribution counts on.", kMeasured, [](P& p) { return &p.control.friction_estimate; }},
  {"control.grip_force", "N", 0.1, 10, 1, "Preferred normal force of a holding finger.", kMeasured, [](P& p) { return &p.control.grip_force; }},
  {"control.grip_ramp_s", "s", 0.01, 10, 1, "Time in which the fingers go from waiting force to grip.", kOurs, [](P& p) { return &p.control.grip_ramp_s; }},
  {"control.grip_weight", "", 1e-5, 1, 1, "Weight of the preferred normal force against the wanted wrench.", kMeasured, [](P& p) { return &p.control.grip_weight; }},
  {"control.joint_filter_s", "s", 0, 1, 1, "Time constant of the low pass on joint angles.", kMeasured, [](P& p) { return &p.control.joint_filter_s; }},
  {"control.limit_margin", "rad", 0, 0.5, 1, "Distance from a joint limit at which a spring begins to push back.", kOurs, [](P& p) { return &p.control.limit_margin; }},
  {"control.limit_stiffness", "N m/rad", 0, 10, 1, "Stiffness of that spring.", kOurs, [](P& p) { return &p.control.limit_stiffness; }},
  {"control.free_stiffness", "N m/rad", 0.05, 3, 1, "Joint stiffness of a finger that touches nothing.", kMeasured, [](P& p) { return &p.control.free_stiffness; }},
  {"control.margin_filter_s", "s", 0, 1, 1, "Time constant of the low pass on load margins.", kMeasured, [](P& p) { return &p.control.margin_filter_s; }},
  {"control.mass_estimate", "kg", 0, 1, 1, "Mass the controller assumes until its integral has learnt the weight.", kOurs, [](P& p) { return &p.control.mass_estimate; }},
  {"control.max_normal_force", "N", 0.5, 30, 1, "Upper bound of a finger's normal force.", kMeasured, [](P& p) { return &p.control.max_normal_force; }},
  {"control.min_normal_force", "N", 0, 2, 1, "Lower bound of a holding finger's normal force.", kMeasured, [](P& p) { return &p.control.min_normal_force; }},
  {"control.normal_force_integral", "1/s", 0, 50, 1, "Integral gain of a sliding finger's normal force.", kOurs, [](P& p) { return &p.control.normal_force_integral; }},
  {"control.pinv_damping", "m", 0, 0.1, 1, "Damping of the pseudo-inverse of the finger Jacobian.", kMeasured, [](P& p) { return &p.control.pinv_damping; }},
  {"control.pose_filter_s", "s", 0, 1, 1, "Time constant of the low pass on the object pose.", kMeasured, [](P& p) { return &p.control.pose_filter_s; }},
  {"control.position_error_limit", "m", 0.0005, 0.1, 1, "The object's position error enters the force law up to this length.", kMeasured, [](P& p) { return &p.control.position_error_limit; }},
  {"control.position_integral", "N/(m s)", 0, 3000, 1, "Integral gain from object position error to force.", kMeasured, [](P& p) { return &p.control.position_integral; }},
  {"control.position_stiffness", "N/m", 0, 2000, 1, "Proportional gain from object position error to force.", kMeasured, [](P& p) { return &p.control.position_stiffness; }},
  {"control.posture_stiffness", "N m/rad", 0, 2, 1, "Posture spring in the null space of the contact force.", kMeasured, [](P& p) { return &p.control.posture_stiffness; }},
  {"control.reapproach_delay_s", "s", 0.001, 1, 1, "A holding finger without contact for so long moves in again.", kMeasured, [](P& p) { return &p.control.reapproach_delay_s; }},
  {"control.reapproach_force", "N", 0.01, 2, 1, "Force with which it moves in.", kMeasured, [](P& p) { return &p.control.reapproach_force; }},
  {"control.reapproach_speed", "m/s", 0.001, 0.2, 1, "Speed with which it moves in.", kMeasured, [](P& p) { return &p.control.reapproach_speed; }},
  {"control.residual_limit", "N", 0.001, 10, 1, "The integrals stop while the contact forces miss the wanted wrench by more.", kMeasured, [](P& p) { return &p.control.residual_limit; }},
  {"control.rotation_error_limit", "rad", 0.01, 3, 1, "The object's orientation error enters the torque law up to this angle.", kMeasured, [](P& p) { return &p.control.rotation_error_limit; }},
  {"control.rotation_integral", "N m/(rad s)", 0, 5, 1, "Integral gain from object orientation error to torque.", kMeasured, [](P& p) { return &p.control.rotation_integral; }},
  {"control.rotation_stiffness", "N m/rad", 0, 5, 1, "Proportional gain from object orientation error to torque.", kMeasured, [](P& p) { return &p.control.rotation_stiffness; }},
  {"control.settle_s", "s", 0, 10, 1, "Time between the stand-in letting go and the state holding.", kOurs, [](P& p) { return &p.control.settle_s; }},
  {"control.slide_force_limit", "N", 0.05, 5, 1, "Largest tangential force of a sliding finger.", kOurs, [](P& p) { return &p.control.slide_force_limit; }},
  {"control.slide_friction_share", "", 0, 1, 1, "Share of a sliding finger's normal force assumed to drag on the object.", kMeasured, [](P& p) { return &p.control.slide_friction_share; }},
  {"control.slide_stiffness", "N/m", 10, 2000, 1, "Tangential stiffness of a sliding finger about its reference.", kOurs, [](P& p) { return &p.control.slide_stiffness; }},
  {"control.stability_measure", "", 0, 3, 1, "Measure that stability means: 0 smallest singular value, 1 epsilon, 2 sqrt(det), 3 isotropy.", kOurs, [](P& p) { return &p.control.stability_measure; }},
  {"control.stability_threshold", "", 0, 100, 1, "Below this stability the criterion `switched` maximises stability.", "Sec. II; value ours", [](P& p) { return &p.control.stability_threshold; }},
  {"control.stand_in_release_s", "s", 0, 10, 1, "Time between full grip and the stand-in letting go.", kOurs, [](P& p) { return &p.control.stand_in_release_s; }},
  {"control.torque_integral_limit", "N m", 0, 1, 1, "Largest integrated object torque, per axis.", kMeasured, [](P& p) { return &p.control.torque_integral_limit; }},
  {"exploration.converged_updates", "", 1, 1000, 1, "Line 3 must hold for so many consecutive updates.", kMeasured, [](P& p) { return &p.exploration.converged_updates; }},
  {"exploration.dither_hz", "Hz", 0.1, 20, 1, "Frequency of the circular dither (least_squares).", kMeasured, [](P& p) { return &p.exploration.dither_hz; }},
  {"exploration.dither_speed", "m/s", 0, 0.05, 1, "Speed of the circular dither (least_squares).", kMeasured, [](P& p) { return &p.exploration.dither_speed; }},
  {"exploration.epsilon", "1/m", 0, 1000, 1, "Line 3: the gradient norm that counts as converged.", kMeasured, [](P& p) { return &p.exploration.epsilon; }},
  {"exploration.eta", "m2/s", 0, 0.01, 1, "Line 11: speed of the contact per unit of gradient.", kMeasured, [](P& p) { return &p.exploration.eta; }},
  {"exploration.forgetting", "", 0.01, 0.999, 1, "Weight of the past per update (least_squares).", kMeasured, [](P& p) { return &p.exploration.forgetting; }},
  {"exploration.gradient_max", "1/m", 1, 1000, 1, "Line 7: cap of the gradient norm.", kMeasured, [](P& p) { return &p.exploration.gradient_max; }},
  {"exploration.clearance", "m", 0, 0.02, 1, "An exploring finger goes no nearer to a link of another finger.", kOurs, [](P& p) { return &p.exploration.clearance; }},
  {"exploration.least_facing", "", -1, 1, 1, "An exploring finger keeps its link axis times the outward normal below this, so that the contact stays on the round tip; 1 turns this off.", kMeasured, [](P& p) { return &p.exploration.least_facing; }},
  {"exploration.limit_margin", "rad", 0, 0.5, 1, "An exploring finger goes no nearer to a joint limit.", kOurs, [](P& p) { return &p.exploration.limit_margin; }},
  {"exploration.lambda", "", 0, 0.999, 1, "Line 8: weight of the past in the sliding mean.", kPaper, [](P& p) { return &p.exploration.lambda; }},
  {"exploration.max_cycles", "ticks", 1, 1e6, 1, "Line 3: N_max.", kMeasured, [](P& p) { return &p.exploration.max_cycles; }},
  {"exploration.max_excursion", "m", 0.0005, 0.1, 1, "A finger explores within this distance of where it started.", kMeasured, [](P& p) { return &p.exploration.max_excursion; }},
  {"exploration.min_displacement", "m", 0, 0.01, 1, "An update waits until the contact has moved so far.", kMeasured, [](P& p) { return &p.exploration.min_displacement; }},
  {"exploration.normal_force", "N", 0.05, 3, 1, "Normal force of the exploring finger.", kMeasured, [](P& p) { return &p.exploration.normal_force; }},
  {"exploration.sigma", "", 0, 10, 1, "Line 2: standard deviation of the start gradient, in units of gradient_max.", kPaper, [](P& p) { return &p.exploration.sigma; }},
  {"exploration.speed_max", "m/s", 0.0005, 0.1, 1, "Line 11: highest speed of the contact.", kOurs, [](P& p) { return &p.exploration.speed_max; }},
  {"exploration.speed_min", "m/s", 0, 0.05, 1, "Line 11: least speed of the contact.", kMeasured, [](P& p) { return &p.exploration.speed_min; }},
  {"exploration.stability_weight", "", 0, 100, 1, "Criterion combined: weight of stability in the linear sum.", "Fig. 2; value ours", [](P& p) { return &p.exploration.stability_weight; }},
  {"exploration.transfer_s", "s", 0.01, 5, 1, "Time of load transfer before and after sliding.", kOurs, [](P& p) { return &p.exploration.transfer_s; }},
  {"exploration.update_cycles", "ticks", 1, 10000, 1, "Line 4: n, ticks between updates of the gradient.", kMeasured, [](P& p) { return &p.exploration.update_cycles; }},
  {"gait.abort_position", "m", 0.0005, 0.05, 1, "A regrasp is broken off when the object is this far from its reference.", kMeasured, [](P& p) { return &p.gait.abort_position; }},
  {"gait.abort_rotation", "rad", 0.01, 1, 1, "The same for its orientation.", kMeasured, [](P& p) { return &p.gait.abort_rotation; }},
  {"gait.acceleration", "rad/s2", 0.1, 50, 1, "Angular acceleration of the object's reference.", kOurs, [](P& p) { return &p.gait.acceleration; }},
  {"gait.across_speed", "m/s", 0.005, 0.5, 1, "Hop: speed of the fingertip above the surface.", kMeasured, [](P& p) { return &p.gait.across_speed; }},
  {"gait.by_need", "", 0, 1, 1, "1: the finger farthest from its target regrasps first; 0: the order of the paper's table.", kOurs, [](P& p) { return &p.gait.by_need; }},
  {"gait.disc_radius", "m", 0, 0.02, 1, "Exploring: a contact stays within this distance of the finger's first one, in the palm.", kMeasured, [](P& p) { return &p.gait.disc_radius; }},
  {"gait.down_speed", "m/s", 0.002, 0.3, 1, "Hop: speed of the fingertip on its way down to the surface.", kMeasured, [](P& p) { return &p.gait.down_speed; }},
  {"gait.estimator", "", 0, 1, 1, "Exploring: 1 estimates the gradient by least squares, 0 by the printed rule.", kPaper, [](P& p) { return &p.gait.estimator; }},
  {"gait.explore_s", "s", 0.05, 20, 1, "Exploring: longest run of Algorithm 1 per regrasp.", kOurs, [](P& p) { return &p.gait.explore_s; }},
  {"gait.grip_force", "N", 0.1, 10, 1, "Preferred normal force of a holding finger during rotate and move.", kMeasured, [](P& p) { return &p.gait.grip_force; }},
  {"gait.hop", "", 0, 1, 1, "1: a finger hops to its target; 0: it slides.", kOurs, [](P& p) { return &p.gait.hop; }},
  {"gait.hop_force", "N", 0.01, 1, 1, "Hop: normal force at which the fingertip leaves the surface.", kMeasured, [](P& p) { return &p.gait.hop_force; }},
  {"gait.lag_position", "m", 0.0002, 0.05, 1, "The turning reference waits while the object is this far behind.", kOurs, [](P& p) { return &p.gait.lag_position; }},
  {"gait.lag_rotation", "rad", 0.01, 1, 1, "The same for its orientation.", kOurs, [](P& p) { return &p.gait.lag_rotation; }},
  {"gait.lead", "", -0.5, 1, 1, "A finger's target lies ahead of its first contact by this share of the step to come.", kOurs, [](P& p) { return &p.gait.lead; }},
  {"gait.lift_height", "m", 0.0005, 0.02, 1, "Hop: height above the surface.", kMeasured, [](P& p) { return &p.gait.lift_height; }},
  {"gait.lift_speed", "m/s", 0.005, 0.5, 1, "Hop: speed of the fingertip on its way up.", kMeasured, [](P& p) { return &p.gait.lift_speed; }},
  {"gait.limit_margin", "rad", 0, 0.5, 1, "A joint this near to the limit it moves to ends object motion, or lets its finger slip (move).", kOurs, [](P& p) { return &p.gait.limit_margin; }},
  {"gait.margin_min", "N", 0, 10, 1, "Least load margin of the grasp without a finger at which that finger may leave.", kMeasured, [](P& p) { return &p.gait.margin_min; }},
  {"gait.margin_wanted", "N", 0, 10, 1, "Load margin without the opposing finger below which better contacts are sought first.", kOurs, [](P& p) { return &p.gait.margin_wanted; }},
  {"gait.max_shift", "m", 0, 0.02, 1, "How far from the present contacts they are sought.", kOurs, [](P& p) { return &p.gait.max_shift; }},
  {"gait.max_excursion", "m", 0.001, 0.1, 1, "Object motion ends with a contact this far from its first place in the palm.", kOurs, [](P& p) { return &p.gait.max_excursion; }},
  {"gait.min_manipulability", "", 0, 1, 1, "Object motion ends with a finger below this share of its first manipulability.", kOurs, [](P& p) { return &p.gait.min_manipulability; }},
  {"gait.mode", "", 0, 1, 1, "0: fingers explore for a better contact; 1: they return to their first one.", kOurs, [](P& p) { return &p.gait.mode; }},
  {"gait.move_speed", "m/s", 0.0005, 0.1, 1, "Speed of the object while it is shifted; a shift and a turn at once go at the speed of the slower one.", kOurs, [](P& p) { return &p.gait.move_speed; }},
  {"gait.settle_s", "s", 0, 5, 1, "Rest between object motion and the first regrasp.", kMeasured, [](P& p) { return &p.gait.settle_s; }},
  {"gait.skip_distance", "m", 0, 0.02, 1, "A finger this near to its target does not regrasp (returning).", kMeasured, [](P& p) { return &p.gait.skip_distance; }},
  {"gait.slide_force", "N", 0.02, 2, 1, "Normal force of a sliding finger.", kMeasured, [](P& p) { return &p.gait.slide_force; }},
  {"gait.slide_gain", "1/s", 0.1, 100, 1, "Sliding speed per distance from the target.", kMeasured, [](P& p) { return &p.gait.slide_gain; }},
  {"gait.slide_speed", "m/s", 0.001, 0.2, 1, "Highest sliding speed.", kMeasured, [](P& p) { return &p.gait.slide_speed; }},
  {"gait.speed_rad_s", "rad/s", 0.001, 2, 1, "Speed of the object while it turns.", kMeasured, [](P& p) { return &p.gait.speed_rad_s; }},
  {"gait.step_rad", "rad", 0.01, 1.5, 1, "Object motion between regrasps.", kMeasured, [](P& p) { return &p.gait.step_rad; }},
  {"gait.transfer_s", "s", 0.001, 2, 1, "Time of load transfer before a finger leaves and after it is back.", kMeasured, [](P& p) { return &p.gait.transfer_s; }},
  {"gravity", "m/s2", -50, 50, 3, "Gravity in W: turning it is tilting the palm.", kOurs, [](P& p) { return p.gravity_W.data(); }},
  {"object.friction", "", 0.01, 1, 1, "True friction coefficient of every contact.", "object model", [](P& p) { return &p.object.friction; }},
  {"object.mass_kg", "kg", 0.001, 2, 1, "True mass of the object.", "object model", [](P& p) { return &p.object.mass_kg; }},
  {"start.displacement_m", "m", 0, 0.01, 1, "Every fingertip arrives so far from its place, along the surface in a direction drawn from the seed; takes effect at reset.", kOurs, [](P& p) { return &p.start.displacement_m; }},
  {"start.joint_sigma_rad", "rad", 0, 0.2, 1, "Spread of the start posture over seeds, per joint; takes effect at reset.", kOurs, [](P& p) { return &p.start.joint_sigma_rad; }},
  {"start.object_sigma_m", "m", 0, 0.02, 1, "Spread of the object's start position over seeds, per axis; takes effect at reset.", kOurs, [](P& p) { return &p.start.object_sigma_m; }},
});
// clang-format on

/// The table in order of names, so that the list above may be in any order.
const auto& Sorted() {
  static const auto sorted = [] {
    auto copy = kTable;
    std::sort(copy.begin(), copy.end(),
              [](const ParameterInfo& a, const ParameterInfo& b) { return a.name < b.name; });
    return copy;
  }();
  return sorted;
}

}  // namespace

std::span<const ParameterInfo> ParameterTable() { return Sorted(); }

int FindParameter(std::string_view name) {
  const auto table = ParameterTable();
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].name == name) return static_cast<int>(i);
  return -1;
}

Parameters DefaultParameters(const LoadedScenario& model) {
  Parameters p;
  p.object.friction = model.object.friction;
  p.object.mass_kg = model.object.mass;
  p.gravity_W = model.scenario.gravity_W;
  return p;
}

}  // namespace regrasp
