#pragma once

/// Which stepper suits a hand, tried on the hand itself.

#include <string>

#include "core/hand/scenario.h"
#include "core/world/world.h"

namespace regrasp {

struct StepperChoice {
  Stepper stepper = Stepper::kFast;
  std::string reason;  ///< one line: what was found, with figures
  bool works = true;   ///< whether one of them moves the hand at all
};

/// Closes the hand of a scenario with both steppers from its preshape: first in the air, then on
/// the object, which the stand-in holds; 0.3 s in all at dt = 1 ms. Where neither faults, the fast
/// step then moves it freely for 1 s. The fast step is chosen where it neither faults nor ends more
/// than `kAgreement` of the motion away from the exact one, where the exact one faults, and,
/// untried, for a hand without joints. Deterministic; a few tens of milliseconds. `config.stepper`
/// does not matter.
StepperChoice ChooseStepper(const LoadedScenario& model, const WorldConfig& config);

}  // namespace regrasp
