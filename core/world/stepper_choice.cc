#include "core/world/stepper_choice.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "core/hand/kinematics.h"

namespace regrasp {
namespace {

constexpr double kDuration = 0.3;    // [s]: most hands have closed by then
constexpr double kStiffness = 1.0;   // [N m/rad] towards the closed posture
constexpr double kAgreement = 0.05;  // of the motion
constexpr double kMotion = 0.1;      // a shorter one counts as this [rad]
constexpr double kFall = 1.0;        // [s]

struct Trial {
  JointVector q;
  std::string fault;
};

Trial Close(const LoadedScenario& model, WorldConfig config, Stepper stepper) {
  const Scenario& scenario = model.scenario;
  config.stepper = stepper;
  World world(model.hand, model.object, config, scenario.q_preshape, scenario.X_WO);
  world.SetGravity(scenario.gravity_W);
  KinematicsData kinematics;
  for (int k = 0; k * config.dt < kDuration; ++k) {
    const JointVector& q = world.state().q;
    ForwardKinematics(model.hand, q, &kinematics);
    world.SetTorque(GravityTorque(model.hand, kinematics, scenario.gravity_W) +
                    kStiffness * (scenario.q_closed - q));
    if (world.Step() != StepStatus::kOk) return {world.state().q, world.fault_cause()};
  }
  return {world.state().q, ""};
}

/// Lets the hand fall from its preshape without any torque: against its stops and itself. The
/// fault, if any.
std::string Fall(const LoadedScenario& model, WorldConfig config) {
  config.stepper = Stepper::kFast;
  World world(model.hand, model.object, config, model.scenario.q_preshape, model.scenario.X_WO);
  world.SetGravity(model.scenario.gravity_W);
  for (int k = 0; k * config.dt < kFall; ++k)
    if (world.Step() != StepStatus::kOk) return world.fault_cause();
  return "";
}

}  // namespace

StepperChoice ChooseStepper(const LoadedScenario& model, const WorldConfig& config) {
  if (model.hand.num_joints() == 0) return {Stepper::kFast, "the hand has no joints"};
  const Trial exact = Close(model, config, Stepper::kExact);
  const Trial fast = Close(model, config, Stepper::kFast);
  if (!exact.fault.empty() && !fast.fault.empty())
    return {Stepper::kFast,
            "neither step can close the hand: the exact one: " + exact.fault +
                "; the fast one: " + fast.fault,
            false};
  if (!fast.fault.empty())
    return {Stepper::kExact, "failed at load: the fast step, closing the hand: " + fast.fault};
  if (!exact.fault.empty())
    return {Stepper::kFast, "failed at load: the exact step, closing the hand: " + exact.fault};
  const std::string fall = Fall(model, config);
  if (!fall.empty())
    return {Stepper::kExact, "failed at load: the fast step, 1 s of free motion: " + fall};
  const double moved = (exact.q - model.scenario.q_preshape).cwiseAbs().maxCoeff();
  const double apart = (exact.q - fast.q).cwiseAbs().maxCoeff();
  const bool agree = apart <= kAgreement * std::max(moved, kMotion);
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "%s at load: closing the hand, the steps differ by %.2g rad in a motion of %.2g "
                "rad, %s %.0f %%%s",
                agree ? "passed" : "failed", apart, moved, agree ? "within" : "more than",
                100 * kAgreement, agree ? "; 1 s of free motion" : "");
  return {agree ? Stepper::kFast : Stepper::kExact, text.data()};
}

}  // namespace regrasp
