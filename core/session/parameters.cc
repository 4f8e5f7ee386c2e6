#include "core/session/parameters.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "core/hand/scenario.h"

namespace regrasp {
namespace {

using P = Parameters;
constexpr std::string_view kOurs = "ours";
constexpr std::string_view kMeasured = "ours, measured";
constexpr std::string_view kPaper = "paper";

/// Type, get and set of a row follow from the member that `Member` points at.
template <typename Member>
constexpr ParameterInfo RowOf(std::string_view name, std::string_view meaning,
                              std::string_view source, Member) {
  using T = std::remove_pointer_t<std::invoke_result_t<Member, Parameters&>>;
  ParameterInfo info;
  info.name = name;
  info.type = std::is_enum_v<T>             ? ParameterType::kWord
              : std::is_same_v<T, bool>     ? ParameterType::kBoolean
              : std::is_same_v<T, int>      ? ParameterType::kInteger
              : std::is_same_v<T, Vector3d> ? ParameterType::kVector
                                            : ParameterType::kReal;
  info.max = 1;
  info.meaning = meaning;
  info.source = source;
  info.get = [](const Parameters& parameters) -> Vector3d {
    const T& value = *Member{}(const_cast<Parameters&>(parameters));  // only read
    if constexpr (std::is_same_v<T, Vector3d>)
      return value;
    else
      return {static_cast<double>(value), 0, 0};
  };
  info.set = [](Parameters* parameters, const Vector3d& value) {
    if constexpr (std::is_same_v<T, Vector3d>)
      *Member{}(*parameters) = value;
    else if constexpr (std::is_enum_v<T>)
      *Member{}(*parameters) = static_cast<T>(static_cast<int>(value.x()));
    else
      *Member{}(*parameters) = static_cast<T>(value.x());
  };
  return info;
}

/// A real, an integer or a vector.
template <typename Member>
constexpr ParameterInfo Row(std::string_view name, std::string_view unit, double min, double max,
                            std::string_view meaning, std::string_view source, Member member) {
  ParameterInfo info = RowOf(name, meaning, source, member);
  info.unit = unit;
  info.min = min;
  info.max = max;
  return info;
}

/// A word.
template <std::size_t N, typename Member>
constexpr ParameterInfo Row(std::string_view name, const std::array<std::string_view, N>& words,
                            std::string_view meaning, std::string_view source, Member member) {
  ParameterInfo info = RowOf(name, meaning, source, member);
  info.words = words;
  info.max = static_cast<double>(N - 1);
  return info;
}

/// A boolean.
template <typename Member>
constexpr ParameterInfo Row(std::string_view name, std::string_view meaning,
                            std::string_view source, Member member) {
  return RowOf(name, meaning, source, member);
}

// clang-format off
// name | unit | min | max | meaning | source of the default | member.
// name | words | meaning | source | member, and name | meaning | source | member for a boolean.
constexpr auto kTable = std::to_array<ParameterInfo>({
  Row("control.close_force", "N", 0.02, 2, "A finger that has touched while the hand closes waits with this force.", kOurs, [](P& p) { return &p.control.close_force; }),
  Row("control.close_speed", "rad/s", 0.05, 3, "Speed of the fastest joint while the hand closes.", kOurs, [](P& p) { return &p.control.close_speed; }),
  Row("control.contact_filter_s", "s", 0, 1, "Time constant of the low pass on contact points and normals, in the fingertip's frame.", kMeasured, [](P& p) { return &p.control.contact_filter_s; }),
  Row("control.contact_from_normal", "Place a contact on the fingertip's known surface by its sensed normal, instead of trusting the sensed position.", kMeasured, [](P& p) { return &p.control.contact_from_normal; }),
  Row("control.contact_lost_s", "s", 0.001, 1, "A finger without contact for so long carries nothing and counts as lost.", kOurs, [](P& p) { return &p.control.contact_lost_s; }),
  Row("control.drop_contact_s", "s", 0.01, 5, "With fewer than two contacts for so long the object counts as dropped.", kOurs, [](P& p) { return &p.control.drop_contact_s; }),
  Row("control.release_s", "s", 0.05, 10, "Time from letting go to the open hand.", kOurs, [](P& p) { return &p.control.release_s; }),
  Row("control.release_pull", "N", 0, 50, "Force with which a released finger leaves the surface, so that none drags on the object.", kMeasured, [](P& p) { return &p.control.release_pull; }),
  Row("control.release_pull_s", "s", 0, 0.1, "For so long.", kMeasured, [](P& p) { return &p.control.release_pull_s; }),
  Row("control.search_s", "s", 0, 20, "A finger that has missed the object seeks it so long after the closed posture is reached.", kOurs, [](P& p) { return &p.control.search_s; }),
  Row("control.search_speed", "m/s", 0.001, 0.2, "Speed with which it moves towards where the object is sensed.", kOurs, [](P& p) { return &p.control.search_speed; }),
  Row("control.slide_slow_speed", "m/s", 1e-05, 0.05, "Below this speed the friction feedforward of a sliding finger fades out.", kOurs, [](P& p) { return &p.control.slide_slow_speed; }),
  Row("control.touch_s", "s", 0.001, 0.5, "Contact for so long counts as a touch while the hand closes.", kOurs, [](P& p) { return &p.control.touch_s; }),
  Row("control.drop_distance", "m", 0.005, 0.5, "An object sensed this far from where control wants it counts as dropped.", kOurs, [](P& p) { return &p.control.drop_distance; }),
  Row("control.force_filter_s", "s", 0, 1, "Time constant of the low pass on contact forces.", kMeasured, [](P& p) { return &p.control.force_filter_s; }),
  Row("control.force_integral_limit", "N", 0, 20, "Largest change of the integrated object force from its start value, per axis.", kMeasured, [](P& p) { return &p.control.force_integral_limit; }),
  Row("control.friction_estimate", "", 0.05, 1, "Friction coefficient the force distribution counts on.", kMeasured, [](P& p) { return &p.control.friction_estimate; }),
  Row("control.grip_force", "N", 0.1, 10, "Preferred normal force of a holding finger.", kMeasured, [](P& p) { return &p.control.grip_force; }),
  Row("control.grip_ramp_s", "s", 0.01, 10, "Time in which the fingers go from waiting force to grip.", kOurs, [](P& p) { return &p.control.grip_ramp_s; }),
  Row("control.grip_weight", "", 1e-5, 1, "Weight of the preferred normal force against the wanted wrench.", kMeasured, [](P& p) { return &p.control.grip_weight; }),
  Row("control.joint_filter_s", "s", 0, 1, "Time constant of the low pass on joint angles.", kMeasured, [](P& p) { return &p.control.joint_filter_s; }),
  Row("control.limit_margin", "rad", 0, 0.5, "Distance from a joint limit at which a spring begins to push back.", kOurs, [](P& p) { return &p.control.limit_margin; }),
  Row("control.limit_stiffness", "N m/rad", 0, 10, "Stiffness of that spring.", kOurs, [](P& p) { return &p.control.limit_stiffness; }),
  Row("control.free_stiffness", "N m/rad", 0.05, 3, "Joint stiffness of a finger that touches nothing.", kMeasured, [](P& p) { return &p.control.free_stiffness; }),
  Row("control.margin_filter_s", "s", 0, 1, "Time constant of the low pass on load margins.", kMeasured, [](P& p) { return &p.control.margin_filter_s; }),
  Row("control.mass_estimate", "kg", 0, 1, "Mass the controller assumes until its integral has learnt the weight.", kOurs, [](P& p) { return &p.control.mass_estimate; }),
  Row("control.max_normal_force", "N", 0.5, 30, "Upper bound of a finger's normal force.", kMeasured, [](P& p) { return &p.control.max_normal_force; }),
  Row("control.min_normal_force", "N", 0, 2, "Lower bound of a holding finger's normal force.", kMeasured, [](P& p) { return &p.control.min_normal_force; }),
  Row("control.normal_force_integral", "1/s", 0, 50, "Integral gain of a sliding finger's normal force.", kOurs, [](P& p) { return &p.control.normal_force_integral; }),
  Row("control.pinv_damping", "m", 0, 0.1, "Damping of the pseudo-inverse of the finger Jacobian.", kMeasured, [](P& p) { return &p.control.pinv_damping; }),
  Row("control.pose_filter_s", "s", 0, 1, "Time constant of the low pass on the object pose.", kMeasured, [](P& p) { return &p.control.pose_filter_s; }),
  Row("control.position_error_limit", "m", 0.0005, 0.1, "The object's position error enters the force law up to this length.", kMeasured, [](P& p) { return &p.control.position_error_limit; }),
  Row("control.position_integral", "N/(m s)", 0, 3000, "Integral gain from object position error to force.", kMeasured, [](P& p) { return &p.control.position_integral; }),
  Row("control.position_stiffness", "N/m", 0, 2000, "Proportional gain from object position error to force.", kMeasured, [](P& p) { return &p.control.position_stiffness; }),
  Row("control.posture_stiffness", "N m/rad", 0, 2, "Posture spring in the null space of the contact force.", kMeasured, [](P& p) { return &p.control.posture_stiffness; }),
  Row("control.reapproach_delay_s", "s", 0.001, 1, "A holding finger without contact for so long moves in again.", kMeasured, [](P& p) { return &p.control.reapproach_delay_s; }),
  Row("control.reapproach_force", "N", 0.01, 2, "Force with which it moves in.", kMeasured, [](P& p) { return &p.control.reapproach_force; }),
  Row("control.reapproach_speed", "m/s", 0.001, 0.2, "Speed with which it moves in.", kMeasured, [](P& p) { return &p.control.reapproach_speed; }),
  Row("control.residual_limit", "N", 0.001, 10, "The integrals stop while the contact forces miss the wanted wrench by more.", kMeasured, [](P& p) { return &p.control.residual_limit; }),
  Row("control.rotation_error_limit", "rad", 0.01, 3, "The object's orientation error enters the torque law up to this angle.", kMeasured, [](P& p) { return &p.control.rotation_error_limit; }),
  Row("control.rotation_integral", "N m/(rad s)", 0, 5, "Integral gain from object orientation error to torque.", kMeasured, [](P& p) { return &p.control.rotation_integral; }),
  Row("control.rotation_stiffness", "N m/rad", 0, 5, "Proportional gain from object orientation error to torque.", kMeasured, [](P& p) { return &p.control.rotation_stiffness; }),
  Row("control.settle_s", "s", 0, 10, "Time between the stand-in letting go and the state holding.", kOurs, [](P& p) { return &p.control.settle_s; }),
  Row("control.slide_force_limit", "N", 0.05, 5, "Largest tangential force of a sliding finger.", kOurs, [](P& p) { return &p.control.slide_force_limit; }),
  Row("control.slide_friction_share", "", 0, 1, "Share of a sliding finger's normal force assumed to drag on the object.", kMeasured, [](P& p) { return &p.control.slide_friction_share; }),
  Row("control.slide_stiffness", "N/m", 10, 2000, "Tangential stiffness of a sliding finger about its reference.", kOurs, [](P& p) { return &p.control.slide_stiffness; }),
  Row("control.stability_measure", kFrameMeasureNames, "Measure that stability means; exploration by stability needs one that is fit for a tick.", kOurs, [](P& p) { return &p.control.stability_measure; }),
  Row("control.stability_threshold", "", 0, 100, "Below this stability the criterion `switched` maximises stability.", "Sec. II; value ours", [](P& p) { return &p.control.stability_threshold; }),
  Row("control.stand_in_release_s", "s", 0, 10, "Time between full grip and the stand-in letting go.", kOurs, [](P& p) { return &p.control.stand_in_release_s; }),
  Row("control.torque_integral_limit", "N m", 0, 1, "Largest integrated object torque, per axis.", kMeasured, [](P& p) { return &p.control.torque_integral_limit; }),
  Row("exploration.converged_updates", "", 1, 1000, "Line 3 must hold for so many consecutive updates.", kMeasured, [](P& p) { return &p.exploration.converged_updates; }),
  Row("exploration.dither_hz", "Hz", 0.1, 20, "Frequency of the circular dither (least_squares).", kMeasured, [](P& p) { return &p.exploration.dither_hz; }),
  Row("exploration.dither_speed", "m/s", 0, 0.05, "Speed of the circular dither (least_squares).", kMeasured, [](P& p) { return &p.exploration.dither_speed; }),
  Row("exploration.epsilon", "1/m", 0, 1000, "Line 3: the gradient norm that counts as converged.", kMeasured, [](P& p) { return &p.exploration.epsilon; }),
  Row("exploration.eta", "m2/s", 0, 0.01, "Line 11: speed of the contact per unit of gradient.", kMeasured, [](P& p) { return &p.exploration.eta; }),
  Row("exploration.forgetting", "", 0.01, 0.999, "Weight of the past per update (least_squares).", kMeasured, [](P& p) { return &p.exploration.forgetting; }),
  Row("exploration.gradient_max", "1/m", 1, 1000, "Line 7: cap of the gradient norm.", kMeasured, [](P& p) { return &p.exploration.gradient_max; }),
  Row("exploration.clearance", "m", 0, 0.02, "An exploring finger goes no nearer to a link of another finger.", kOurs, [](P& p) { return &p.exploration.clearance; }),
  Row("exploration.least_facing", "", -1, 1, "An exploring finger keeps its link axis times the outward normal below this, so that the contact stays on the round tip; 1 turns this off.", kMeasured, [](P& p) { return &p.exploration.least_facing; }),
  Row("exploration.limit_margin", "rad", 0, 0.5, "An exploring finger goes no nearer to a joint limit.", kOurs, [](P& p) { return &p.exploration.limit_margin; }),
  Row("exploration.lambda", "", 0, 0.999, "Line 8: weight of the past in the sliding mean.", kPaper, [](P& p) { return &p.exploration.lambda; }),
  Row("exploration.max_cycles", "ticks", 1, 1e6, "Line 3: N_max.", kMeasured, [](P& p) { return &p.exploration.max_cycles; }),
  Row("exploration.max_excursion", "m", 0.0005, 0.1, "A finger explores within this distance of where it started.", kMeasured, [](P& p) { return &p.exploration.max_excursion; }),
  Row("exploration.min_displacement", "m", 0, 0.01, "An update waits until the contact has moved so far.", kMeasured, [](P& p) { return &p.exploration.min_displacement; }),
  Row("exploration.normal_force", "N", 0.05, 3, "Normal force of the exploring finger.", kMeasured, [](P& p) { return &p.exploration.normal_force; }),
  Row("exploration.sigma", "", 0, 10, "Line 2: standard deviation of the start gradient, in units of gradient_max.", kPaper, [](P& p) { return &p.exploration.sigma; }),
  Row("exploration.speed_max", "m/s", 0.0005, 0.1, "Line 11: highest speed of the contact.", kOurs, [](P& p) { return &p.exploration.speed_max; }),
  Row("exploration.speed_min", "m/s", 0, 0.05, "Line 11: least speed of the contact.", kMeasured, [](P& p) { return &p.exploration.speed_min; }),
  Row("exploration.stability_weight", "", 0, 100, "Criterion combined: weight of stability in the linear sum.", "Fig. 2; value ours", [](P& p) { return &p.exploration.stability_weight; }),
  Row("exploration.turn_axis", "", -1, 1, "Criterion reserve, explore: axis of the coming turn in W, sense included; its length does not count, but 0 is refused.", kOurs, [](P& p) { return &p.exploration.turn_axis_W; }),
  Row("exploration.reserve_manipulability", "rad", 0, 10, "Criterion reserve: manipulability counts so much beside it.", kOurs, [](P& p) { return &p.exploration.reserve_manipulability; }),
  Row("exploration.reserve_margin_wanted", "N", 0, 10, "Criterion reserve: load margin of the grasp that is to be kept.", kOurs, [](P& p) { return &p.exploration.reserve_margin_wanted; }),
  Row("exploration.reserve_margin_cost", "rad/N", 0, 100, "Criterion reserve: what each newton below that costs.", kOurs, [](P& p) { return &p.exploration.reserve_margin_cost; }),
  Row("exploration.transfer_s", "s", 0.01, 5, "Time of load transfer before and after sliding.", kOurs, [](P& p) { return &p.exploration.transfer_s; }),
  Row("exploration.update_cycles", "ticks", 1, 10000, "Line 4: n, ticks between updates of the gradient.", kMeasured, [](P& p) { return &p.exploration.update_cycles; }),
  Row("exploration.arrived", "m", 5e-05, 0.005, "The way back to the best contact, and to a recalled one, ends this near.", kMeasured, [](P& p) { return &p.exploration.arrived; }),
  Row("exploration.best_filter_s", "s", 0, 2, "Time constant of the low pass on phi and contact point before they count as the best met.", kMeasured, [](P& p) { return &p.exploration.best_filter_s; }),
  Row("exploration.disc_slack", "m", 0, 0.005, "A best contact may be so far beyond the disc of the gait.", kOurs, [](P& p) { return &p.exploration.disc_slack; }),
  Row("exploration.force_share", "", 0, 2, "The exploring finger presses with this share of the load margin without it, at most normal_force.", kMeasured, [](P& p) { return &p.exploration.force_share; }),
  Row("exploration.least_force", "", 0.1, 1, "Least share of normal_force that it presses with.", kMeasured, [](P& p) { return &p.exploration.least_force; }),
  Row("exploration.little_gain", "", 1, 2, "Algorithm 1 tries again while the best phi is below so much of the first one.", kMeasured, [](P& p) { return &p.exploration.little_gain; }),
  Row("exploration.lost_contact_s", "s", 0.01, 5, "A sliding finger without a contact reading for so long has lost its contact.", kMeasured, [](P& p) { return &p.exploration.lost_contact_s; }),
  Row("exploration.object_slow", "m", 0, 0.05, "A sliding finger slows down beyond this position error of the object.", kMeasured, [](P& p) { return &p.exploration.object_slow; }),
  Row("exploration.object_stop", "m", 0.0005, 0.05, "It waits beyond this position error of the object.", kMeasured, [](P& p) { return &p.exploration.object_stop; }),
  Row("exploration.object_wait_s", "s", 0.01, 5, "Waiting for the object for so long ends the exploration.", kOurs, [](P& p) { return &p.exploration.object_wait_s; }),
  Row("exploration.reload_limit_s", "s", 0.05, 10, "A finger that takes up its load for so long without contact has no surface to stand on.", kOurs, [](P& p) { return &p.exploration.reload_limit_s; }),
  Row("exploration.return_gain", "1/s", 0.1, 100, "Sliding speed per distance on the way back to the best contact.", kOurs, [](P& p) { return &p.exploration.return_gain; }),
  Row("exploration.return_limit_s", "s", 0.05, 20, "Longest way back to the best contact.", kOurs, [](P& p) { return &p.exploration.return_limit_s; }),
  Row("exploration.settle_s", "s", 0, 5, "Rest between load transfer and Algorithm 1, until the filters follow.", kMeasured, [](P& p) { return &p.exploration.settle_s; }),
  Row("exploration.tries", "", 1, 20, "Runs of Algorithm 1 in one exploration, while little is gained and half of N_max is left.", kMeasured, [](P& p) { return &p.exploration.tries; }),
  Row("exploration.worth_returning", "", 1, 2, "The finger goes back to the best contact when its phi is above so much of the last one.", kMeasured, [](P& p) { return &p.exploration.worth_returning; }),
  Row("gait.abort_position", "m", 0.0005, 0.05, "A regrasp is broken off when the object is this far from its reference.", kMeasured, [](P& p) { return &p.gait.abort_position; }),
  Row("gait.abort_rotation", "rad", 0.01, 1, "The same for its orientation.", kMeasured, [](P& p) { return &p.gait.abort_rotation; }),
  Row("gait.acceleration", "rad/s2", 0.1, 50, "Angular acceleration of the object's reference.", kOurs, [](P& p) { return &p.gait.acceleration; }),
  Row("gait.across_speed", "m/s", 0.005, 0.5, "Hop: speed of the fingertip above the surface.", kMeasured, [](P& p) { return &p.gait.across_speed; }),
  Row("gait.along_ahead_s", "s", 0.05, 10, "While a finger regrasps the object turns no faster than the others can follow for so long.", kMeasured, [](P& p) { return &p.gait.along_ahead_s; }),
  Row("gait.along_explore_speed", "rad/s", 0, 2, "Highest speed at which the object turns while a finger explores; 0: it rests.", kMeasured, [](P& p) { return &p.gait.along_explore_speed; }),
  Row("gait.along_margin", "N", 0, 10, "While a finger regrasps the object turns more slowly where the load margin of the others is below this, down to rest at gait.margin_min.", kMeasured, [](P& p) { return &p.gait.along_margin; }),
  Row("gait.along_speed", "rad/s", 0, 2, "Planned landings: highest speed at which the object turns while a finger regrasps; 0: it rests.", kMeasured, [](P& p) { return &p.gait.along_speed; }),
  Row("gait.by_need", "The finger farthest from its target regrasps first, instead of the order of the paper's table.", kOurs, [](P& p) { return &p.gait.by_need; }),
  Row("gait.disc_radius", "m", 0, 0.02, "Exploring: a contact stays within this distance of the finger's first one, in the palm.", kMeasured, [](P& p) { return &p.gait.disc_radius; }),
  Row("gait.down_speed", "m/s", 0.002, 0.3, "Hop: speed of the fingertip on its way down to the surface.", kMeasured, [](P& p) { return &p.gait.down_speed; }),
  Row("gait.estimator", kEstimatorNames, "Exploring: how the gradient is estimated; secant is the rule as printed.", kMeasured, [](P& p) { return &p.gait.estimator; }),
  Row("gait.explore", kGaitExploreNames, "Exploring: which regrasping fingers explore; unknown: those on unknown surface, and those whose last explorations gained enough.", kMeasured, [](P& p) { return &p.gait.explore; }),
  Row("gait.criterion", kCriterionNames, "Exploring: what a finger maximises, but the one before the opposing finger: that one makes stable what holds without the opposing finger.", "Sec. III b: switched", [](P& p) { return &p.gait.criterion; }),
  Row("gait.map", "Planned landings: what was felt is kept; else only the present contacts are known.", kOurs, [](P& p) { return &p.gait.map; }),
  Row("gait.whole_stance", "Planned landings: contacts of all the others are planned together where a finger is still refused.", kMeasured, [](P& p) { return &p.gait.whole_stance; }),
  Row("gait.explore_gain", "", 0, 1, "Exploring where unknown: also with this relative gain of the finger's last explorations.", kOurs, [](P& p) { return &p.gait.explore_gain; }),
  Row("gait.explore_unknown", "rad", 0, 3.2, "Exploring where unknown: from this angle between the landing and what was felt on.", kOurs, [](P& p) { return &p.gait.explore_unknown; }),
  Row("gait.explore_s", "s", 0.05, 20, "Exploring: longest run of Algorithm 1 per regrasp.", kOurs, [](P& p) { return &p.gait.explore_s; }),
  Row("gait.grip_force", "N", 0.1, 10, "Preferred normal force of a holding finger during rotate and move.", kMeasured, [](P& p) { return &p.gait.grip_force; }),
  Row("gait.hop", "A finger hops to its target, instead of sliding there.", kOurs, [](P& p) { return &p.gait.hop; }),
  Row("gait.hop_force", "N", 0.01, 1, "Hop: normal force at which the fingertip leaves the surface.", kMeasured, [](P& p) { return &p.gait.hop_force; }),
  Row("gait.lag_position", "m", 0.0002, 0.05, "The turning reference waits while the object is this far behind.", kOurs, [](P& p) { return &p.gait.lag_position; }),
  Row("gait.lag_rotation", "rad", 0.01, 1, "The same for its orientation.", kOurs, [](P& p) { return &p.gait.lag_rotation; }),
  Row("gait.lead", "", -0.5, 1, "A finger's target lies ahead of its first contact by this share of the step to come.", kOurs, [](P& p) { return &p.gait.lead; }),
  Row("gait.lift_height", "m", 0.0005, 0.02, "Hop: height above the surface.", kMeasured, [](P& p) { return &p.gait.lift_height; }),
  Row("gait.lift_speed", "m/s", 0.005, 0.5, "Hop: speed of the fingertip on its way up.", kMeasured, [](P& p) { return &p.gait.lift_speed; }),
  Row("gait.limit_margin", "rad", 0, 0.5, "A joint this near to the limit it moves to ends object motion, or lets its finger slip (move).", kOurs, [](P& p) { return &p.gait.limit_margin; }),
  Row("gait.margin_min", "N", 0, 10, "Least load margin of the grasp without a finger at which that finger may leave.", kMeasured, [](P& p) { return &p.gait.margin_min; }),
  Row("gait.margin_wanted", "N", 0, 10, "Load margin without the opposing finger below which better contacts are sought first.", kOurs, [](P& p) { return &p.gait.margin_wanted; }),
  Row("gait.max_shift", "m", 0, 0.02, "How far from the present contacts they are sought.", kOurs, [](P& p) { return &p.gait.max_shift; }),
  Row("gait.max_excursion", "m", 0.001, 0.1, "Object motion ends with a contact this far from its first place in the palm.", kOurs, [](P& p) { return &p.gait.max_excursion; }),
  Row("gait.min_manipulability", "", 0, 1, "Object motion ends with a finger below this share of its first manipulability.", kOurs, [](P& p) { return &p.gait.min_manipulability; }),
  Row("gait.mode", kGaitModeNames, "What a regrasping finger looks for: a better contact, by Algorithm 1, or its first one.", kOurs, [](P& p) { return &p.gait.mode; }),
  Row("gait.move_speed", "m/s", 0.0005, 0.1, "Speed of the object while it is shifted; a shift and a turn at once go at the speed of the slower one.", kOurs, [](P& p) { return &p.gait.move_speed; }),
  Row("gait.settle_s", "s", 0, 5, "Rest between object motion and the first regrasp.", kMeasured, [](P& p) { return &p.gait.settle_s; }),
  Row("gait.skip_distance", "m", 0, 0.02, "A finger this near to its target does not regrasp (returning).", kMeasured, [](P& p) { return &p.gait.skip_distance; }),
  Row("gait.slide_force", "N", 0.02, 2, "Normal force of a sliding finger.", kMeasured, [](P& p) { return &p.gait.slide_force; }),
  Row("gait.slide_gain", "1/s", 0.1, 100, "Sliding speed per distance from the target.", kMeasured, [](P& p) { return &p.gait.slide_gain; }),
  Row("gait.slide_speed", "m/s", 0.001, 0.2, "Highest sliding speed.", kMeasured, [](P& p) { return &p.gait.slide_speed; }),
  Row("gait.speed_rad_s", "rad/s", 0.001, 2, "Speed of the object while it turns.", kMeasured, [](P& p) { return &p.gait.speed_rad_s; }),
  Row("gait.step_rad", "rad", 0.01, 1.5, "Object motion between regrasps.", kMeasured, [](P& p) { return &p.gait.step_rad; }),
  Row("gait.transfer_s", "s", 0.001, 2, "Time of load transfer before a finger leaves and after it is back.", kMeasured, [](P& p) { return &p.gait.transfer_s; }),
  Row("gait.clear_distance", "m", 0, 0.01, "Hop: after so far above the surface a touch is an obstacle.", kMeasured, [](P& p) { return &p.gait.clear_distance; }),
  Row("gait.explore_settle_s", "s", 0, 5, "Exploring: rest before Algorithm 1, until the filters follow.", kMeasured, [](P& p) { return &p.gait.explore_settle_s; }),
  Row("gait.land_depth", "m", 0, 0.05, "Hop: so far below where the finger left there is no surface.", kOurs, [](P& p) { return &p.gait.land_depth; }),
  Row("gait.land_distance", "m", 0.0001, 0.01, "Hop: this near to above its target the finger comes down.", kMeasured, [](P& p) { return &p.gait.land_distance; }),
  Row("gait.land_late_s", "s", 0, 5, "Hop: the finger comes down anyway so long after its target got there.", kMeasured, [](P& p) { return &p.gait.land_late_s; }),
  Row("gait.return_limit_s", "s", 0.05, 20, "Exploring: longest way to where the last explorations ended, and back to the best contact.", kMeasured, [](P& p) { return &p.gait.return_limit_s; }),
  Row("gait.slide_arrived", "m", 5e-05, 0.005, "A slide to the target ends this near.", kOurs, [](P& p) { return &p.gait.slide_arrived; }),
  Row("gait.slide_limit_s", "s", 0.05, 20, "Longest slide to the target.", kOurs, [](P& p) { return &p.gait.slide_limit_s; }),
  Row("gait.touch_s", "s", 0.001, 0.1, "Hop: a landing counts after so long in contact.", kMeasured, [](P& p) { return &p.gait.touch_s; }),
  Row("gait.careful_s", "s", 0.001, 2, "Planned landings: load transfer of a finger without which the load margin is below gait.margin_wanted.", kMeasured, [](P& p) { return &p.gait.careful_s; }),
  Row("gait.doubt", "", 0, 2, "A contact's normal may be off by this share of the spread of the normals felt about it, which costs load margin.", kMeasured, [](P& p) { return &p.gait.doubt; }),
  Row("gait.forgive", "The object's reference follows an error that lasts, and later motions win it back.", kMeasured, [](P& p) { return &p.gait.forgive; }),
  Row("gait.friction_share", "", 0, 1, "Planned landings: share of the friction that sliding fingers have felt, which forces and load margins count on instead of control.friction_estimate; 0 feels none.", kMeasured, [](P& p) { return &p.gait.friction_share; }),
  Row("gait.rub_s", "s", 0, 2, "Planned landings: so long a finger slides before it leaves, to feel the friction.", kMeasured, [](P& p) { return &p.gait.rub_s; }),
  Row("gait.rubs", "", 0, 1000, "Planned landings: the first so many leaving fingers do so.", kOurs, [](P& p) { return &p.gait.rubs; }),
  Row("gait.plan", "Where a finger lands is planned on the felt surface, instead of at its first contact.", kMeasured, [](P& p) { return &p.gait.plan; }),
  Row("gait.preset", kGaitPresetNames, "Sets gait.mode, plan, forgive, margin_min, max_excursion, along_speed and explore: planned landings, or the paper's gait.", kOurs, [](P& p) { return &p.gait.preset; }),
  Row("gait.reserve_wanted", "rad", 0, 3, "Planned landings: motion reserve that counts in full.", kMeasured, [](P& p) { return &p.gait.reserve_wanted; }),
  Row("gait.recover_limit_s", "s", 0.05, 20, "Longest hold after a regrasp was broken off.", kMeasured, [](P& p) { return &p.gait.recover_limit_s; }),
  Row("gait.recovered", "", 0.05, 1, "The hold ends when the object's error is below this share of the limits at which a regrasp is broken off.", kMeasured, [](P& p) { return &p.gait.recovered; }),
  Row("gait.second_thought_s", "s", 0, 5, "A finger is refused when the margin has been low for so long.", kMeasured, [](P& p) { return &p.gait.second_thought_s; }),
  Row("gait.finish_s", "s", 0, 5, "Rest at the end of a rotation, and at most gait.recover_limit_s until the object is where it shall be.", kMeasured, [](P& p) { return &p.gait.finish_s; }),
  Row("gait.progress", "rad", 0, 0.5, "A cycle that turns the object less has not turned it.", kMeasured, [](P& p) { return &p.gait.progress; }),
  Row("gait.idle_cycles", "", 0, 1000, "By the table: the gait gives up after so many cycles in a row that have not turned the object.", kMeasured, [](P& p) { return &p.gait.idle_cycles; }),
  Row("gait.patience", "", 0, 1000, "The same with planned landings.", kMeasured, [](P& p) { return &p.gait.patience; }),
  Row("gait.misses", "", 1, 1000, "Planned landings: the gait gives up after so many in a row that found no surface.", kMeasured, [](P& p) { return &p.gait.misses; }),
  Row("gait.lead_max", "rad", 0, 1.5, "A finger that ended motions at its joint limit has its target turned back further, by at most this.", kMeasured, [](P& p) { return &p.gait.lead_max; }),
  Row("gait.found_share", "", 0, 1, "Exploring: weight of the newest exploration's end in where the next one goes first.", kMeasured, [](P& p) { return &p.gait.found_share; }),
  Row("gait.disc_inside", "", 0, 1, "Exploring: what is remembered lies within this share of the disc's radius.", kMeasured, [](P& p) { return &p.gait.disc_inside; }),
  Row("gait.disc_full", "", 0, 10, "Exploring: the whole disc is free when the margin without the opposing finger is this share of gait.margin_wanted.", kMeasured, [](P& p) { return &p.gait.disc_full; }),
  Row("gait.want_more", "", 1, 10, "After a refusal of the opposing finger, contacts are sought that allow this times the margin wanted before.", kMeasured, [](P& p) { return &p.gait.want_more; }),
  Row("gait.plan_reach", "m", 0.001, 0.05, "Planned landings: candidates lie so far about the home.", kMeasured, [](P& p) { return &p.gait.plan_reach; }),
  Row("gait.room_reach", "m", 0.001, 0.05, "Planned landings: the same, to make room for a refused finger.", kMeasured, [](P& p) { return &p.gait.room_reach; }),
  Row("gait.room_gain", "N", 0, 5, "Planned landings: gain in load margin for which a finger makes room for a refused one.", kMeasured, [](P& p) { return &p.gait.room_gain; }),
  Row("gait.reserve_needed", "rad", 0, 3, "Planned landings: a refused finger with as much motion reserve may stay behind.", kMeasured, [](P& p) { return &p.gait.reserve_needed; }),
  Row("gait.stance_reach", "m", 0.001, 0.05, "Planned stances: contacts lie so far from the present ones.", kMeasured, [](P& p) { return &p.gait.stance_reach; }),
  Row("gait.steady_s", "s", 0, 1, "A finger that has touched for so long stands.", kMeasured, [](P& p) { return &p.gait.steady_s; }),
  Row("gait.away_s", "s", 0, 5, "A finger that has not touched for so long is not counted on.", kMeasured, [](P& p) { return &p.gait.away_s; }),
  Row("gait.leave_share", "", 0, 1, "Planned landings: while a finger leaves, this share of the errors that break a regrasp off does so.", kMeasured, [](P& p) { return &p.gait.leave_share; }),
  Row("gait.margin_least", "N", 0, 10, "Planned landings: the load margin asked for halves with every cycle without progress, but not below this.", kMeasured, [](P& p) { return &p.gait.margin_least; }),
  Row("gait.worth", "", 0, 10, "Planned landings: gain in the landing's score for which a finger leaves.", kMeasured, [](P& p) { return &p.gait.worth; }),
  Row("gait.worth_scarce", "", 0, 10, "Planned landings: so much more of it where the margin without the finger is 0, in proportion below gait.margin_wanted.", kMeasured, [](P& p) { return &p.gait.worth_scarce; }),
  Row("gait.slip_s", "s", 0.001, 1, "Planned landings: another finger without contact for so long while one leaves breaks the regrasp off.", kMeasured, [](P& p) { return &p.gait.slip_s; }),
  Row("gait.caution", "N", 0, 10, "After that the finger needs so much more load margin to leave.", kMeasured, [](P& p) { return &p.gait.caution; }),
  Row("gait.caution_kept", "", 0, 1, "A regrasp that went well leaves this share of it.", kMeasured, [](P& p) { return &p.gait.caution_kept; }),
  Row("gait.still_s", "s", 0, 20, "Forgiving: an object that has rested for so long at the end of a hold is where it is, whatever the margin.", kMeasured, [](P& p) { return &p.gait.still_s; }),
  Row("gait.still_position", "m", 0, 0.02, "Forgiving: it has rested if it moved less than this.", kMeasured, [](P& p) { return &p.gait.still_position; }),
  Row("gait.still_rotation", "rad", 0, 1, "Forgiving: and turned less than this.", kMeasured, [](P& p) { return &p.gait.still_rotation; }),
  Row("gait.forgive_margin", "N", 0, 10, "Forgiving: otherwise the reference follows with this load margin only.", kMeasured, [](P& p) { return &p.gait.forgive_margin; }),
  Row("gait.forgive_position", "m", 0, 0.02, "Forgiving: so much of the error in position stays.", kMeasured, [](P& p) { return &p.gait.forgive_position; }),
  Row("gait.forgive_rotation", "rad", 0, 1, "Forgiving: so much of the error in orientation stays.", kMeasured, [](P& p) { return &p.gait.forgive_rotation; }),
  Row("gait.win_back_rotation", "rad", 0, 1, "Forgiving: tilt that a motion wins back, at most.", kMeasured, [](P& p) { return &p.gait.win_back_rotation; }),
  Row("gait.win_back_position", "m", 0, 0.02, "Forgiving: offset that a motion wins back, at most.", kMeasured, [](P& p) { return &p.gait.win_back_position; }),
  Row("gait.margin_counts", "", 0, 1, "Planned landings: from this share of a motion on a low load margin ends it.", kMeasured, [](P& p) { return &p.gait.margin_counts; }),
  Row("gait.margin_share", "", 0, 1, "Planned landings: which is below this share of gait.margin_min.", kMeasured, [](P& p) { return &p.gait.margin_share; }),
  Row("gait.stuck_s", "s", 0.01, 20, "Object motion ends after waiting for the object for so long.", kMeasured, [](P& p) { return &p.gait.stuck_s; }),
  Row("gait.stuck_yielding_s", "s", 0.01, 20, "The same in move, where a finger that begins to slip takes its time.", kMeasured, [](P& p) { return &p.gait.stuck_yielding_s; }),
  Row("gait.limit_rate", "", 0, 10, "A joint that moves less than this per turn of the object may stand at its limit.", kMeasured, [](P& p) { return &p.gait.limit_rate; }),
  Row("gait.limit_rate_shift", "rad/m", 0, 1000, "The same per shift of the object.", kMeasured, [](P& p) { return &p.gait.limit_rate_shift; }),
  Row("gait.yielding_cap", "", 1, 10, "Move: a finger that shall slip presses with at most this times gait.slide_force.", kMeasured, [](P& p) { return &p.gait.yielding_cap; }),
  Row("gait.rest_s", "s", 0, 5, "Move: rest at its end, until the object has caught up with its reference.", kMeasured, [](P& p) { return &p.gait.rest_s; }),
  Row("gravity", "m/s2", -50, 50, "Gravity in W: turning it is tilting the palm.", kOurs, [](P& p) { return &p.gravity_W; }),
  Row("object.friction", "", 0.01, 1, "True friction coefficient of every contact.", "object model", [](P& p) { return &p.object.friction; }),
  Row("object.mass_kg", "kg", 0.001, 2, "True mass of the object.", "object model", [](P& p) { return &p.object.mass_kg; }),
  Row("start.displacement_m", "m", 0, 0.01, "Every fingertip arrives so far from its place, along the surface in a direction drawn from the seed; takes effect at reset.", kOurs, [](P& p) { return &p.start.displacement_m; }),
  Row("start.joint_sigma_rad", "rad", 0, 0.2, "Spread of the start posture over seeds, per joint; takes effect at reset.", kOurs, [](P& p) { return &p.start.joint_sigma_rad; }),
  Row("start.object_sigma_m", "m", 0, 0.02, "Spread of the object's start position over seeds, per axis; takes effect at reset.", kOurs, [](P& p) { return &p.start.object_sigma_m; }),
  Row("control.fingertip_stiffness", "N/m", 100, 1e9, "A fingertip is pressed in by its normal force over this; places the contact on it.", "the hand's: docs/world.md", [](P& p) { return &p.control.fingertip_stiffness; }),
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

std::string_view Name(ParameterType type) {
  static constexpr std::string_view kNames[] = {"real", "integer", "boolean", "word", "vector"};
  return kNames[static_cast<std::size_t>(type)];
}

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
